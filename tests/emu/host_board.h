/* The hardware as a program on this computer has it: memory, queues, and a radio that remembers registers. */
#ifndef HOST_BOARD_H
#define HOST_BOARD_H

#include <stdbool.h>
#include <stdint.h>

/* Called with every byte on SPI ('S'), and with the levels of CSN ('N') and CE ('E'). */
extern void (*host_log)(char kind, uint8_t value);
extern uint8_t host_memory[256];
extern bool host_radio_present;

void host_power_on(void);
void host_serial_in(const uint8_t *bytes, uint32_t count);
uint32_t host_serial_out(uint8_t *bytes, uint32_t room);
/* The payload that the radio was last given, and whether there was a new one since the last call. */
bool host_packet(uint8_t packet[32], uint8_t *size, uint8_t *channel, uint8_t address[5]);

#endif
