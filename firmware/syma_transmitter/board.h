/* The hardware as the rest of the firmware sees it. board_avr.c is the ATmega328P; the tests bring their own. */
#ifndef BOARD_H
#define BOARD_H

#include <stdbool.h>
#include <stdint.h>

/* SPI to the radio: one byte out, one byte in, most significant bit first. */
uint8_t spi_exchange(uint8_t out);
/* Chip select of the radio: selected is pin low. */
void radio_select(bool selected);
/* Pin CE of the radio: in transmit mode, high lets it send what is in its queue. */
void radio_enable(bool enabled);

/* Next byte from the host; false if there is none. */
bool serial_read(uint8_t *byte);
/* Queue bytes for the host, all of them or, if there is no room, none. Never waits. */
bool serial_write(const uint8_t *bytes, uint8_t count);
/* Bytes from the host that were lost (overrun, framing, queue full), modulo 256. */
uint8_t serial_lost(void);

/* Memory that outlives power. A write takes milliseconds: begin one only while it is idle. */
uint8_t memory_read(uint8_t place);
bool memory_idle(void);
void memory_write(uint8_t place, uint8_t byte);

#endif
