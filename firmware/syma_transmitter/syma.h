/* The Syma X protocol of 2014 and later (X5C-1, X11, X12, ...): contents of a packet, and its channel.
 *
 *   data  throttle, pitch, yaw, roll, camera, pitch trim + rate, yaw trim + flip, roll trim, tail, sum
 *   bind  id4 id3 id2 id1 id0 AA AA AA 00 sum
 *   sum   (exclusive or of bytes 0 ... 8) + 0x55
 *
 * One packet every 4 ms; the four channels take turns, two packets on each.
 */
#ifndef SYMA_H
#define SYMA_H

#include <stdint.h>

#include "config.h"
#include "pilot.h"

#define SYMA_SIZE 10
#define SYMA_ADDRESS_SIZE 5

extern const uint8_t syma_bind_address[SYMA_ADDRESS_SIZE];

/* Write the four channels of an id, MHz above 2400. */
void syma_channels(uint8_t id0, uint8_t channels[4]);
/* Channel of a bind packet; packets are numbered since binding began. */
uint8_t syma_bind_channel(const struct config *config, uint16_t number);
void syma_bind_packet(uint8_t packet[SYMA_SIZE], const struct config *config);
void syma_data_packet(uint8_t packet[SYMA_SIZE], const struct config *config, const struct sticks *sticks);

#endif
