/* CRC-8 of CRSF: polynomial 0xD5, start 0, most significant bit first. */
#ifndef CRC8_H
#define CRC8_H

#include <stdint.h>

uint8_t crc8(const uint8_t *bytes, uint8_t count);

#endif
