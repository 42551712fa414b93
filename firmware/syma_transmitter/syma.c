#include "syma.h"

#include <string.h>

const uint8_t syma_bind_address[SYMA_ADDRESS_SIZE] = {0xAB, 0xAC, 0xAD, 0xAE, 0xAF};

enum { ROLL_BIT = 1, PITCH_BIT = 2, YAW_BIT = 4 };

void syma_channels(uint8_t id0, uint8_t channels[4])
{
    static const uint8_t first[3][4] = {{10, 26, 42, 58}, {42, 10, 66, 34}, {26, 58, 18, 50}};
    static const uint8_t last[2][4] = {{33, 65, 24, 56}, {33, 65, 25, 57}};
    uint8_t row = id0 & 31;
    if (row >= 30) {
        memcpy(channels, last[row - 30], 4);
        return;
    }
    uint8_t block = row < 16 ? 0 : row < 24 ? 1 : 2;
    uint8_t step = block ? row & 7 : row;
    if (row == 6)
        step = 7;
    for (uint8_t i = 0; i < 4; i++)
        channels[i] = (uint8_t)(first[block][i] + step + (row == 22 && i < 2));
}

uint8_t syma_bind_channel(const struct config *config, uint16_t number)
{
    static const uint8_t agreed[3] = {0x4B, 0x30, 0x40};
    uint8_t slot = (uint8_t)(number / 2 % 4);
    return slot < 3 ? agreed[slot] : config->bind_channel[number / 8 % 2];
}

static void seal(uint8_t packet[SYMA_SIZE])
{
    uint8_t sum = 0;
    for (uint8_t i = 0; i < SYMA_SIZE - 1; i++)
        sum ^= packet[i];
    packet[SYMA_SIZE - 1] = (uint8_t)(sum + 0x55);
}

void syma_bind_packet(uint8_t packet[SYMA_SIZE], const struct config *config)
{
    for (uint8_t i = 0; i < 5; i++)
        packet[i] = config->id[4 - i];
    memset(packet + 5, 0xAA, 3);
    packet[8] = 0;
    seal(packet);
}

/* Encode as sign and magnitude; the sign bit means negative, or positive on a reversed axis. */
static uint8_t axis(int8_t stick, uint8_t reversed)
{
    uint8_t size = (uint8_t)(stick < 0 ? -stick : stick);
    return (uint8_t)(size && (stick < 0) != (reversed != 0) ? 0x80 | size : size);
}

/* The configured trim, or a quarter of the stick, which adds to its range. */
static uint8_t trim(const struct config *config, uint8_t which, uint8_t stick)
{
    if (config->options & CONFIG_TRIM_FOLLOWS_STICK)
        return (uint8_t)((stick & 0x80) >> 2 | (stick & 0x7F) >> 2);
    return config->trim[which];
}

void syma_data_packet(uint8_t packet[SYMA_SIZE], const struct config *config, const struct sticks *sticks)
{
    packet[0] = sticks->throttle;
    packet[1] = axis(sticks->pitch, config->reversed & PITCH_BIT);
    packet[2] = axis(sticks->yaw, config->reversed & YAW_BIT);
    packet[3] = axis(sticks->roll, config->reversed & ROLL_BIT);
    packet[4] = 0;
    packet[5] = (uint8_t)(0x40 | (sticks->fast ? 0x80 : 0) | trim(config, 0, packet[1]));
    packet[6] = (uint8_t)((sticks->flip ? 0x40 : 0) | trim(config, 1, packet[2]));
    packet[7] = trim(config, 2, packet[3]);
    packet[8] = config->tail;
    seal(packet);
}
