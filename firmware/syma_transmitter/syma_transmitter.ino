// For the Arduino IDE: open this file, choose the board, upload. The program is in the .c files beside it; its
// main() takes the place of setup() and loop(). README.md says what to wire and what to set.
