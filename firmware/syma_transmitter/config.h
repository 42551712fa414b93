/* What differs between batches of the toy: kept in memory that outlives power, set from the host. */
#ifndef CONFIG_H
#define CONFIG_H

#include <stdbool.h>
#include <stdint.h>

#define CONFIG_SIZE 14

/* The bytes in this order are the payload of the frames and, with a CRC-8 behind them, the stored form. */
struct config {
    uint8_t layout;          /* 1 */
    uint8_t id[5];           /* address in flight; id[0] chooses the channels, id[4] is A2 (X5SC, X5SW: A1) */
    uint8_t bind_channel[2]; /* the fourth bind channel, which handsets disagree on: these two in turn */
    uint8_t reversed;        /* bit 0 roll, 1 pitch, 2 yaw: the sign bit means positive, not negative */
    uint8_t options;         /* CONFIG_... below */
    uint8_t trim[3];         /* pitch, yaw, roll: bit 5 negative, bits 4 ... 0 magnitude */
    uint8_t tail;            /* byte 8 of a packet: 0, X5SW 1 */
};

enum { CONFIG_BIND_AT_POWER_ON = 1, CONFIG_TRIM_FOLLOWS_STICK = 2 };
enum config_result { CONFIG_IS_STORED, CONFIG_IS_DEFAULT, CONFIG_REFUSED_FLYING, CONFIG_REFUSED_VALUES };

extern const struct config config_default;

bool config_valid(const struct config *config);
/* Read the stored configuration, either copy; the default and false if neither is whole. */
bool config_load(struct config *config);
/* Begin to store: config_store_step(), called while it returns true, writes a byte at a time. */
void config_store(const struct config *config);
bool config_store_step(void);

#endif
