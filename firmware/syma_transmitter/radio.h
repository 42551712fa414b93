/* The radio chip nRF24L01+, with the registers that a Syma handset sets. */
#ifndef RADIO_H
#define RADIO_H

#include <stdbool.h>
#include <stdint.h>

/* Set all registers; true if the chip was powered up already, so that it can send at once. */
bool radio_begin(void);
/* Whether the chip answers and its registers are still set; a dip of its supply resets them. */
bool radio_healthy(void);
void radio_address(const uint8_t address[5]);
/* Select the channel of the next packet. The one before must have been sent. */
void radio_prepare(uint8_t channel);
void radio_send(const uint8_t *packet, uint8_t count);

#endif
