/* Interface to the hardware. board_avr.c implements it for the ATmega328P; the tests have their own. */
#ifndef BOARD_H
#define BOARD_H

#include <stdbool.h>
#include <stdint.h>

/* Exchange one byte with the radio by SPI, most significant bit first. */
uint8_t spi_exchange(uint8_t out);
/* Chip select of the radio (CSN): selected means pin low. */
void radio_select(bool selected);
/* Pin CE of the radio: in transmit mode, high makes it send the packets in its queue. */
void radio_enable(bool enabled);

/* Read the next byte from the host; false if there is none. */
bool serial_read(uint8_t *byte);
/* Queue bytes for the host: all of them or, if the queue lacks room, none. Never waits. */
bool serial_write(const uint8_t *bytes, uint8_t count);
/* Number of lost bytes from the host (overrun, framing error, queue full), modulo 256. */
uint8_t serial_lost(void);

/* EEPROM. A write takes milliseconds: begin one only while memory_idle(). */
uint8_t memory_read(uint8_t place);
bool memory_idle(void);
void memory_write(uint8_t place, uint8_t byte);

#endif
