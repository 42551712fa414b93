/* The transmitter: receives frames, sends packets, reports its status. Uses board.h; the caller keeps the time.
 *
 * Every 4 ms:  transmitter_tick()     loads a packet into the radio, which sends it in 0.58 ms
 *   2 ms later transmitter_prepare()  selects the channel of the next one
 * else         transmitter_work()     one short task: a received byte, a status, a byte to EEPROM
 */
#ifndef TRANSMITTER_H
#define TRANSMITTER_H

#include <stdbool.h>

#define PROTOCOL_VERSION 1
#define FIRMWARE_MAJOR 1
#define FIRMWARE_MINOR 0

/* Reason of a start. Only a power-on may bind: after the others a quadcopter may be flying. */
enum start { START_POWER_ON, START_WATCHDOG, START_OTHER_RESET };

/* Flags of the status frame. */
enum {
    FLAG_NO_RADIO = 1,        /* the radio chip does not answer correctly */
    FLAG_WATCHDOG = 2,        /* the last start was a reset by the watchdog */
    FLAG_OTHER_RESET = 4,     /* the last start was a reset without loss of power */
    FLAG_DEFAULT_CONFIG = 8,  /* no valid configuration is stored */
    FLAG_STORING = 16,        /* a configuration is being stored */
    FLAG_MAY_ARM = 32         /* arm low and throttle zero were received: arm high will arm */
};

void transmitter_begin(enum start why);
void transmitter_tick(void);
void transmitter_prepare(void);
/* Do one task; false if there is none. Takes at most WORK_US microseconds. */
bool transmitter_work(void);
#define WORK_US 200

#endif
