// For the Arduino IDE: open this file, choose the board, upload. The program is in the .c files of this folder;
// its main() replaces setup() and loop(). README.md explains the wiring and the settings.
