/* Arming, failsafe, and the sticks that are sent. Independent of serial port and radio. */
#ifndef PILOT_H
#define PILOT_H

#include <stdbool.h>
#include <stdint.h>

#include "crsf.h"

#define BIND_PACKETS 345   /* 1.38 s at one per tick */
#define TICK_MS 4
#define NEUTRAL_TICKS 26   /* age of the last good frame at which sticks become neutral: 100 ... 104 ms */
#define FAILSAFE_TICKS 61  /* and at which the throttle becomes zero: 240 ... 244 ms */
#define ARM_LOW_FRAMES 3   /* good frames in a row with arm low and throttle zero that are needed before arm high */

enum state {
    STATE_BINDING,  /* sends bind packets; commands are ignored */
    STATE_LOCKED,   /* throttle zero; may be armed */
    STATE_ARMED,    /* commands are flown */
    STATE_HOLDING,  /* no good frame for 100 ms: sticks neutral, throttle unchanged */
    STATE_FAILSAFE  /* none for 240 ms, or a reset in flight: throttle zero until the host disarms */
};

/* A damaged frame has the right CRC once in 256 times, so one frame alone may move a stick away from neutral, or raise
 * the throttle, by no more than a step; the second one alike takes it all the way, and one that was alone is forgotten
 * with the next. The host's safety filter changes a
 * stick by up to 8 and the throttle by up to 3 in a second, 41 and 31 of these units in the 40 ms of a picture: that
 * passes at once. The steps are for each STEP_TICKS since the last good frame. Lower throttle, a stick toward neutral,
 * and the arm switch never wait. */
#define STICK_STEP 48
#define THROTTLE_STEP 38
#define STEP_TICKS 10

struct sticks {
    uint8_t throttle;       /* 0 ... 255 */
    int8_t pitch, yaw, roll; /* -127 ... 127; forward, right, right */
    bool fast, flip;
};

struct pilot {
    enum state state;
    uint8_t low_frames;      /* counts up to ARM_LOW_FRAMES */
    uint16_t age;            /* of the last good frame, ticks, saturated */
    uint16_t bind_left;      /* bind packets still to send */
    struct sticks heard, before; /* sticks of the last good frame, and of the one before it */
    struct sticks flown;     /* those of them that are believed: what is sent while armed */
};

/* Start with bind packets, or locked; in_flight: after a reset that was no power-on. */
void pilot_begin(struct pilot *pilot, bool bind, bool in_flight);
/* Process the channels of a good frame: roll, pitch, throttle, yaw (AETR), arm, rate, flip. */
void pilot_frame(struct pilot *pilot, const uint16_t channels[CHANNELS]);
/* Call every 4 ms. */
void pilot_tick(struct pilot *pilot);
/* Start to bind; false while motors may be turning. */
bool pilot_bind(struct pilot *pilot);
/* Call after each bind packet. */
void pilot_bind_packet(struct pilot *pilot);
/* The sticks to send now. */
struct sticks pilot_sticks(const struct pilot *pilot);
bool pilot_flying(const struct pilot *pilot);

#endif
