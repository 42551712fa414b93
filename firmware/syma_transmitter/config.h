/* Configuration: what differs between series of the toy. Stored in EEPROM, set by the host. */
#ifndef CONFIG_H
#define CONFIG_H

#include <stdbool.h>
#include <stdint.h>

#define CONFIG_SIZE 14

/* These bytes, in this order, are the payload of the frames and, followed by a CRC-8, the stored form. */
struct config {
    uint8_t layout;          /* 1 */
    uint8_t id[5];           /* radio address in flight; id[0] selects the channels, id[4] is A2 (X5SC, X5SW: A1) */
    uint8_t bind_channel[2]; /* fourth bind channel, MHz above 2400; handsets differ, so these two alternate */
    uint8_t reversed;        /* bit 0 roll, 1 pitch, 2 yaw: the sign bit of this axis means positive */
    uint8_t options;         /* bits: CONFIG_... below */
    uint8_t trim[3];         /* pitch, yaw, roll: bit 5 negative, bits 4 ... 0 magnitude */
    uint8_t tail;            /* byte 8 of a packet: 0, X5SW 1 */
};

enum { CONFIG_BIND_AT_POWER_ON = 1, CONFIG_TRIM_FOLLOWS_STICK = 2 };
enum config_result { CONFIG_IS_STORED, CONFIG_IS_DEFAULT, CONFIG_REFUSED_FLYING, CONFIG_REFUSED_VALUES };

extern const struct config config_default;

bool config_valid(const struct config *config);
/* Load the stored configuration, from either copy; if neither is valid, the default and false. */
bool config_load(struct config *config);
/* Start to store. config_store_step() then writes one byte at a time; call it until it returns false. */
void config_store(const struct config *config);
bool config_store_step(void);

#endif
