#include "host_board.h"

#include <string.h>

#include "board.h"

#define QUEUE 4096
#define TX_ROOM 63

void (*host_log)(char kind, uint8_t value);
uint8_t host_memory[256];
bool host_radio_present = true;

static uint8_t in[QUEUE], out[QUEUE], lost;
static uint32_t in_head, in_tail, out_head, out_tail;
static uint8_t registers[32], address[5];
static uint8_t spi[64], spi_count, packet[32], packet_size;
static bool packet_new;

static void tell(char kind, uint8_t value)
{
    if (host_log)
        host_log(kind, value);
}

void host_power_on(void)
{
    memset(registers, 0, sizeof registers);
    in_head = in_tail = out_head = out_tail = 0;
    lost = spi_count = 0;
    packet_new = false;
}

void host_serial_in(const uint8_t *bytes, uint32_t count)
{
    while (count--) {
        if (in_head - in_tail == QUEUE)
            lost++;
        else
            in[in_head++ % QUEUE] = *bytes;
        bytes++;
    }
}

uint32_t host_serial_out(uint8_t *bytes, uint32_t room)
{
    uint32_t count = 0;
    while (count < room && out_tail != out_head)
        bytes[count++] = out[out_tail++ % QUEUE];
    return count;
}

bool host_packet(uint8_t taken[32], uint8_t *size, uint8_t *channel, uint8_t to[5])
{
    bool fresh = packet_new;
    packet_new = false;
    memcpy(taken, packet, packet_size);
    *size = packet_size;
    *channel = registers[5];
    memcpy(to, address, 5);
    return fresh;
}

bool serial_read(uint8_t *byte)
{
    if (in_tail == in_head)
        return false;
    *byte = in[in_tail++ % QUEUE];
    return true;
}

bool serial_write(const uint8_t *bytes, uint8_t count)
{
    if (count > TX_ROOM - (out_head - out_tail))
        return false;
    while (count--)
        out[out_head++ % QUEUE] = *bytes++;
    return true;
}

uint8_t serial_lost(void)
{
    return lost;
}

uint8_t spi_exchange(uint8_t byte)
{
    uint8_t answer = 0;
    tell('S', byte);
    if (!host_radio_present)
        return 0xFF;
    if (spi_count == 0)
        answer = 0x0E;
    else if (spi[0] < 0x20)
        answer = registers[spi[0]];
    if (spi_count < sizeof spi)
        spi[spi_count++] = byte;
    return answer;
}

static void command_ends(void)
{
    if (spi_count < 2)
        return;
    uint8_t size = (uint8_t)(spi_count - 1);
    if (spi[0] == 0x30 && size == 5)
        memcpy(address, spi + 1, 5);
    else if ((spi[0] & 0xE0) == 0x20)
        registers[spi[0] & 0x1F] = spi[1];
    else if (spi[0] == 0xA0 && size <= 32) {
        memcpy(packet, spi + 1, size);
        packet_size = size;
        packet_new = true;
    }
}

void radio_select(bool selected)
{
    tell('N', !selected);
    if (!selected)
        command_ends();
    spi_count = 0;
}

void radio_enable(bool enabled)
{
    tell('E', enabled);
}

uint8_t memory_read(uint8_t place)
{
    return host_memory[place];
}

bool memory_idle(void)
{
    return true;
}

void memory_write(uint8_t place, uint8_t byte)
{
    host_memory[place] = byte;
}
