/* The nRF24L01+: set up as a Syma handset sets up its own. */
#ifndef RADIO_H
#define RADIO_H

#include <stdbool.h>
#include <stdint.h>

/* Set all registers; true if the chip was powered up already and needs no time to wake. */
bool radio_begin(void);
/* Whether the chip is there and still set up; a dip of its supply makes it forget. */
bool radio_healthy(void);
void radio_address(const uint8_t address[5]);
/* Tune for the next packet. The one before it must be off the air. */
void radio_prepare(uint8_t channel);
void radio_send(const uint8_t *packet, uint8_t count);

#endif
