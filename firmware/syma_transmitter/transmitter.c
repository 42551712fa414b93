#include "transmitter.h"

#include <string.h>

#include "board.h"
#include "config.h"
#include "crsf.h"
#include "pilot.h"
#include "radio.h"
#include "syma.h"

#define STATUS_SIZE 19
#define STATUS_TICKS 25  /* longest time between two status frames: 100 ms */
#define ALIKE 2          /* status frames at once after a change of state: a host need not believe a single one */
#define WAKE_TICKS 3     /* the radio needs up to 5 ms after power-up */
#define HEALTH_PACKETS 64

static struct {
    struct crsf crsf;
    struct pilot pilot;
    struct config config;
    uint8_t flags;
    uint8_t wake;           /* ticks until the radio can send */
    bool tuned;             /* the channel of the next packet is set */
    bool on_bind_address, address_set;
    uint8_t channels[4];    /* of the configured id */
    uint16_t number;        /* of the next packet, counted since this address was set */
    uint8_t throttle;       /* of the last packet */
    uint16_t good;          /* count of channel frames */
    uint16_t echo;          /* channel 16 of the last good frame */
    uint8_t status_age;     /* ticks since the last status */
    enum state told;        /* state in the last status, */
    uint8_t told_times;     /* in so many of them in a row, up to ALIKE */
    bool status_due, config_due;
    enum config_result config_result;
} t;

static void radio_restart(void)
{
    t.wake = radio_begin() ? 0 : WAKE_TICKS;
    t.address_set = t.tuned = false;
}

static void use_config(void)
{
    syma_channels(t.config.id[0], t.channels);
    t.address_set = false;
}

void transmitter_begin(enum start why)
{
    memset(&t, 0, sizeof t);
    t.flags = why == START_WATCHDOG ? FLAG_WATCHDOG : why == START_OTHER_RESET ? FLAG_OTHER_RESET : 0;
    if (!config_load(&t.config))
        t.flags |= FLAG_DEFAULT_CONFIG;
    use_config();
    bool cold = why == START_POWER_ON;
    pilot_begin(&t.pilot, cold && (t.config.options & CONFIG_BIND_AT_POWER_ON), !cold);
    radio_restart();
}

static bool binding(void)
{
    return t.pilot.state == STATE_BINDING;
}

void transmitter_prepare(void)
{
    if (t.wake)
        return;
    if (!t.address_set || t.on_bind_address != binding()) {
        t.on_bind_address = binding();
        radio_address(t.on_bind_address ? syma_bind_address : t.config.id);
        t.address_set = true;
        t.number = 0;
    } else if (t.number % HEALTH_PACKETS == 0) {
        if (!radio_healthy()) {
            t.flags |= FLAG_NO_RADIO;
            radio_restart();
            return;
        }
        t.flags &= (uint8_t)~FLAG_NO_RADIO;
    }
    radio_prepare(t.on_bind_address ? syma_bind_channel(&t.config, t.number) : t.channels[t.number / 2 % 4]);
    t.tuned = true;
}

void transmitter_tick(void)
{
    pilot_tick(&t.pilot);
    if (++t.status_age >= STATUS_TICKS || t.pilot.state != t.told || t.told_times < ALIKE)
        t.status_due = true;
    if (t.wake)
        t.wake--;
    if (!t.tuned)
        return;
    uint8_t packet[SYMA_SIZE];
    if (t.on_bind_address) {
        syma_bind_packet(packet, &t.config);
        t.throttle = 0;
        pilot_bind_packet(&t.pilot);
    } else {
        struct sticks sticks = pilot_sticks(&t.pilot);
        syma_data_packet(packet, &t.config, &sticks);
        t.throttle = sticks.throttle;
    }
    radio_send(packet, SYMA_SIZE);
    t.number++;
    t.tuned = false;
}

static void put16(uint8_t *place, uint16_t value)
{
    place[0] = (uint8_t)(value >> 8);
    place[1] = (uint8_t)value;
}

static bool send_status(void)
{
    uint8_t frame[STATUS_SIZE + CRSF_FRAMING];
    uint8_t *p = frame + 3;
    uint16_t age = t.pilot.age < UINT16_MAX / TICK_MS ? t.pilot.age * TICK_MS : UINT16_MAX;
    bool may_arm = t.pilot.state == STATE_LOCKED && t.pilot.low_frames == ARM_LOW_FRAMES;
    p[0] = PROTOCOL_VERSION;
    p[1] = FIRMWARE_MAJOR;
    p[2] = FIRMWARE_MINOR;
    p[3] = (uint8_t)t.pilot.state;
    p[4] = (uint8_t)(t.flags | (may_arm ? FLAG_MAY_ARM : 0));
    put16(p + 5, t.good);
    put16(p + 7, t.crsf.bad);
    p[9] = serial_lost();
    put16(p + 10, age);
    put16(p + 12, t.echo);
    p[14] = t.throttle;
    p[15] = t.pilot.heard.throttle;
    p[16] = (uint8_t)t.pilot.heard.pitch;
    p[17] = (uint8_t)t.pilot.heard.yaw;
    p[18] = (uint8_t)t.pilot.heard.roll;
    if (!serial_write(frame, crsf_frame(frame, CRSF_STATUS, STATUS_SIZE)))
        return false;
    if (t.pilot.state != t.told)
        t.told_times = 0;
    t.told = t.pilot.state;
    if (t.told_times < ALIKE)
        t.told_times++;
    t.status_age = 0;
    return true;
}

static bool send_config(void)
{
    uint8_t frame[1 + CONFIG_SIZE + CRSF_FRAMING];
    frame[3] = (uint8_t)t.config_result;
    memcpy(frame + 4, &t.config, CONFIG_SIZE);
    return serial_write(frame, crsf_frame(frame, CRSF_CONFIG, 1 + CONFIG_SIZE));
}

static enum config_result write_config(const uint8_t *bytes)
{
    struct config wish;
    memcpy(&wish, bytes, CONFIG_SIZE);
    if (pilot_flying(&t.pilot))
        return CONFIG_REFUSED_FLYING;
    if (!config_valid(&wish))
        return CONFIG_REFUSED_VALUES;
    t.config = wish;
    t.flags = (uint8_t)((t.flags & ~FLAG_DEFAULT_CONFIG) | FLAG_STORING);
    t.status_due = true; /* sent before the answer, so that the host knows that storing has begun */
    config_store(&wish);
    use_config();
    return CONFIG_IS_STORED;
}

static void handle_frame(void)
{
    const uint8_t *payload = t.crsf.bytes + 3;
    switch (t.crsf.bytes[2]) {
    case CRSF_CHANNELS:
        t.good++;
        t.echo = t.crsf.channels[CHANNELS - 1];
        pilot_frame(&t.pilot, t.crsf.channels);
        t.status_due = true;
        return;
    case CRSF_READ_CONFIG:
        t.config_result = t.flags & FLAG_DEFAULT_CONFIG ? CONFIG_IS_DEFAULT : CONFIG_IS_STORED;
        t.config_due = true;
        return;
    case CRSF_WRITE_CONFIG:
        t.config_result = write_config(payload + 3);
        t.config_due = true;
        return;
    case CRSF_BIND:
        pilot_bind(&t.pilot);
        t.status_due = true;
        return;
    }
}

bool transmitter_work(void)
{
    uint8_t byte;
    if (crsf_next(&t.crsf)) {
        handle_frame();
        return true;
    }
    if (serial_read(&byte)) {
        crsf_take(&t.crsf, byte);
        return true;
    }
    if (t.status_due && send_status()) {
        t.status_due = false;
        return true;
    }
    if (t.config_due && send_config()) {
        t.config_due = false;
        return true;
    }
    bool storing = config_store_step();
    t.flags = (uint8_t)(storing ? t.flags | FLAG_STORING : t.flags & ~FLAG_STORING);
    return false;
}
