#include "radio.h"

#include "board.h"

enum {
    READ = 0x00, WRITE = 0x20, WRITE_PAYLOAD = 0xA0, FLUSH_TX = 0xE1,
    CONFIG = 0x00, SETUP_AW = 0x03, RF_CH = 0x05, RF_SETUP = 0x06, STATUS = 0x07, TX_ADDR = 0x10
};
#define AWAKE 0x0E      /* CONFIG: 16-bit CRC, powered up, transmitter */
#define RATE_250K 0x27  /* RF_SETUP: 250 kbit/s, full power */
#define WIDTH_5 0x03    /* SETUP_AW: five bytes of address */

/* Registers and values, in the order in which a real handset writes them. */
static const uint8_t set_up[][2] = {
    {CONFIG, 0x0C},     /* 16-bit CRC, still powered down */
    {0x01, 0x00},       /* no acknowledgements */
    {0x02, 0x3F},       /* all receive pipes enabled, as in the handset */
    {SETUP_AW, WIDTH_5},
    {0x04, 0xFF},
    {RF_CH, 0x08},
    {RF_SETUP, RATE_250K},
    {STATUS, 0x70},     /* clear all flags */
    {0x08, 0x00}, {0x09, 0x00},
    {0x0C, 0xC3}, {0x0D, 0xC4}, {0x0E, 0xC5}, {0x0F, 0xC6},
    {0x11, 10}, {0x12, 10}, {0x13, 10}, {0x14, 10}, {0x15, 10}, {0x16, 10},
    {0x17, 0x00},
};

static uint8_t transfer(uint8_t command, uint8_t byte)
{
    radio_select(true);
    spi_exchange(command);
    uint8_t answer = spi_exchange(byte);
    radio_select(false);
    return answer;
}

static void transfer_many(uint8_t command, const uint8_t *bytes, uint8_t count)
{
    radio_select(true);
    spi_exchange(command);
    while (count--)
        spi_exchange(*bytes++);
    radio_select(false);
}

bool radio_begin(void)
{
    bool awake = transfer(READ | CONFIG, 0) == AWAKE;
    radio_enable(false);
    for (uint8_t i = 0; i < sizeof set_up / sizeof *set_up; i++)
        /* Powering up again takes milliseconds: keep the chip powered if a reset found it so. */
        if (!awake || set_up[i][0] != CONFIG)
            transfer(WRITE | set_up[i][0], set_up[i][1]);
    transfer(FLUSH_TX, 0);
    transfer(WRITE | CONFIG, AWAKE);
    radio_enable(true);
    return awake;
}

bool radio_healthy(void)
{
    return transfer(READ | CONFIG, 0) == AWAKE && transfer(READ | RF_SETUP, 0) == RATE_250K
        && transfer(READ | SETUP_AW, 0) == WIDTH_5;
}

void radio_address(const uint8_t address[5])
{
    transfer_many(WRITE | TX_ADDR, address, 5);
}

void radio_prepare(uint8_t channel)
{
    transfer(READ | STATUS, 0);
    transfer(WRITE | STATUS, 0x2E);
    transfer(WRITE | RF_CH, channel);
    transfer(FLUSH_TX, 0);
}

void radio_send(const uint8_t *packet, uint8_t count)
{
    transfer_many(WRITE_PAYLOAD, packet, count);
}
