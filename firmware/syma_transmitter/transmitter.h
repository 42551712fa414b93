/* The transmitter: frames in, packets out, status back. Hardware comes from board.h, time from its caller.
 *
 * Every 4 ms:  transmitter_tick()     the packet is loaded; it is on the air for 0.58 ms
 *   2 ms later transmitter_prepare()  the radio is tuned for the next one
 * else         transmitter_work()     one short piece of work: a byte, a report, a byte to memory
 */
#ifndef TRANSMITTER_H
#define TRANSMITTER_H

#include <stdbool.h>

#define PROTOCOL_VERSION 1
#define FIRMWARE_MAJOR 1
#define FIRMWARE_MINOR 0

/* Why the firmware starts. Only the first binds: after the others a quadcopter may be in the air. */
enum start { START_POWER_ON, START_WATCHDOG, START_OTHER_RESET };

/* Flags of the status frame. */
enum {
    FLAG_NO_RADIO = 1,        /* the radio chip does not answer as it should */
    FLAG_WATCHDOG = 2,        /* the last start was the watchdog's */
    FLAG_OTHER_RESET = 4,     /* the last start was a reset without loss of power */
    FLAG_DEFAULT_CONFIG = 8,  /* nothing valid was stored */
    FLAG_STORING = 16,        /* a configuration is being stored */
    FLAG_MAY_ARM = 32         /* arm low and throttle zero were seen: arm high will arm */
};

void transmitter_begin(enum start why);
void transmitter_tick(void);
void transmitter_prepare(void);
/* Returns false if there is nothing to do. Takes at most WORK_US. */
bool transmitter_work(void);
#define WORK_US 200

#endif
