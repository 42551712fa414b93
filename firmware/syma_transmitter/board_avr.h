/* The ATmega328P at 16 MHz (Arduino Uno, Nano, Pro Mini): what main.c needs in addition to board.h.
 *
 *   radio   CE  D9 (PB1), CSN D10 (PB2), MOSI D11 (PB3), MISO D12 (PB4), SCK D13 (PB5)
 *   serial  115200 baud, 8N1, on D0 and D1
 */
#ifndef BOARD_AVR_H
#define BOARD_AVR_H

#include <stdbool.h>

#include "board.h"
#include "transmitter.h"

void board_begin(void);
enum start board_start(void);
/* Each returns true once per 4 ms; board_half_tick() 2 ms after board_tick(). */
bool board_tick(void);
bool board_half_tick(void);
/* Whether a piece of work of WORK_US that begins now ends before the next tick. */
bool board_has_time(void);
/* Sleep until the next interrupt. */
void board_rest(void);

#endif
