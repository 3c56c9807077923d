/* A host in C: makes the packet of docs/reference/host.md and prints its bytes; send them over UDP.
 *
 *     cc -O2 -Wall -o host host.c && ./host
 *
 * Numbers are little-endian IEEE 754 single precision, as on every common target. */
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define NUMBERS 22
#define BYTES (16 + 4 * NUMBERS)

static uint32_t crc32(const uint8_t *bytes, size_t count) {
    uint32_t sum = 0xFFFFFFFFu;
    for (size_t k = 0; k < count; k++) {
        sum ^= bytes[k];
        for (int bit = 0; bit < 8; bit++) sum = sum & 1 ? sum >> 1 ^ 0xEDB88320u : sum >> 1;
    }
    return ~sum;
}

static void word(uint8_t *to, uint32_t value) {
    for (int k = 0; k < 4; k++) to[k] = (uint8_t)(value >> 8 * k);
}

static void encode(uint8_t packet[BYTES], uint32_t sequence, uint32_t switches, const float numbers[NUMBERS]) {
    memcpy(packet, "FFH2", 4);
    word(packet + 4, sequence);
    word(packet + 8, switches);
    for (int k = 0; k < NUMBERS; k++) {
        uint32_t bits;
        memcpy(&bits, &numbers[k], 4);
        word(packet + 12 + 4 * k, bits);
    }
    word(packet + BYTES - 4, crc32(packet, BYTES - 4));
}

int main(void) {
    const float numbers[NUMBERS] = {6000.0f, 1.5f, 0.05f, -0.1f, 120.0f, 15.0f, 0.5f, -300.0f, 0.02f, 400.0f,
                                    250.0f, 12.0f, 62.0f, 0.07f, -0.02f, 0.1f, 0.05f, -0.03f, 1.4f, 0.18f, 0.06f, 0.35f};
    uint8_t packet[BYTES];
    encode(packet, 7, 3, numbers);
    for (int k = 0; k < BYTES; k++) printf("%02x", packet[k]);
    printf("\n");
    return 0;
}
