#include "config.h"

#include <string.h>

#include "board.h"
#include "crc8.h"

/* Addresses of two copies: if power fails during a write, one of them stays valid. Address 0 is not used: it is the
 * first one to be damaged by a failing supply. */
static const uint8_t places[2] = {16, 48};
#define STORED_SIZE (CONFIG_SIZE + 1)
#define HIGHEST_CHANNEL 83 /* 2483 MHz, the end of the license-free band */

const struct config config_default = {
    .layout = 1,
    .id = {0x7A, 0x9B, 0x08, 0x00, 0xA2},
    .bind_channel = {0x20, 0x09},
    .options = CONFIG_BIND_AT_POWER_ON,
};

/* The frames and the stored form rely on a struct without gaps. */
typedef char config_has_no_gaps[sizeof(struct config) == CONFIG_SIZE ? 1 : -1];

static uint8_t pending[STORED_SIZE];
static uint8_t written = 2 * STORED_SIZE; /* nothing to store */

bool config_valid(const struct config *config)
{
    if (config->layout != 1 || config->reversed > 7 || config->options > 3)
        return false;
    if (config->bind_channel[0] > HIGHEST_CHANNEL || config->bind_channel[1] > HIGHEST_CHANNEL)
        return false;
    return config->trim[0] < 0x40 && config->trim[1] < 0x40 && config->trim[2] < 0x40;
}

bool config_load(struct config *config)
{
    uint8_t stored[STORED_SIZE];
    for (uint8_t copy = 0; copy < 2; copy++) {
        for (uint8_t i = 0; i < STORED_SIZE; i++)
            stored[i] = memory_read((uint8_t)(places[copy] + i));
        memcpy(config, stored, CONFIG_SIZE);
        if (crc8(stored, CONFIG_SIZE) == stored[CONFIG_SIZE] && config_valid(config))
            return true;
    }
    *config = config_default;
    return false;
}

void config_store(const struct config *config)
{
    memcpy(pending, config, CONFIG_SIZE);
    pending[CONFIG_SIZE] = crc8(pending, CONFIG_SIZE);
    written = 0;
}

bool config_store_step(void)
{
    if (written == 2 * STORED_SIZE)
        return false;
    if (!memory_idle())
        return true;
    uint8_t i = (uint8_t)(written % STORED_SIZE);
    uint8_t place = (uint8_t)(places[written / STORED_SIZE] + i);
    if (memory_read(place) != pending[i])
        memory_write(place, pending[i]);
    written++;
    return true;
}
