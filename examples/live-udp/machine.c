/* A machine over the network, for the live loop of forcefeel: where a driver for hardware begins.
 *
 *     cc -O2 -Wall -o machine examples/live-udp/machine.c && ./machine 5006
 *     forcefeel run elevator-2khz --law robust --machine 127.0.0.1:5006 --headless --duration 10
 *
 * It answers every command with a sample of a column on a link behind a drive that moves at a speed in proportion to its command: a stand-in
 * for trying out the packets, no loader that a law was designed for. Put your sensors and your amplifier in its place.
 * Packets: docs/reference/live.md. A little-endian machine with IEEE 754 numbers, as nearly all are, is taken for granted.
 */
#include <arpa/inet.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#pragma pack(push, 1)
typedef struct {
    char magic[4];          /* FFLV */
    uint16_t version, kind; /* 2; 1 */
    uint64_t sequence, session, answers, clock_ns; /* session key of the loop; cycle of its newest command */
    double force_n, position_m, base_m, pilot_force_n, grip_force_n;
    uint32_t flags, crc; /* bit 0: emergency stop, bit 1: the drive carries out no commands; CRC-32 of all before it */
} sample_packet;

typedef struct {
    char magic[4];
    uint16_t version, kind; /* 2; 2 a command, 3 asks for samples */
    uint64_t cycle, session, answers;
    double command;
    uint32_t enable, state, zero, crc;
} command_packet;
#pragma pack(pop)

_Static_assert(sizeof(sample_packet) == 88 && sizeof(command_packet) == 56, "layout of the packets");

/* CRC-32 as of Ethernet and zlib, bit by bit. */
static uint32_t crc32(const void *data, size_t bytes) {
    const uint8_t *at = data;
    uint32_t crc = 0xffffffff;
    while (bytes--) {
        crc ^= *at++;
        for (int k = 0; k < 8; k++) crc = (crc >> 1) ^ (0xedb88320 & -(crc & 1));
    }
    return ~crc;
}

/* Drive, link and column; SI units. */
typedef struct {
    double drive, base, rate, force;
} machine;

static void move(machine *m, double command, double period_s) {
    const double speed_per_volt = 0.05, stiffness = 3.0e5, damping = 2.0e3, mass = 60.0, ratio = 0.5;
    const int steps = 20;
    const double h = period_s / steps;
    for (int k = 0; k < steps; k++) {
        m->drive += h * speed_per_volt * command;
        m->force = stiffness * (m->drive - ratio * m->base) - damping * ratio * m->rate;
        m->rate += h * ratio * m->force / mass;
        m->base += h * m->rate;
    }
}

/* What a sample answers before the first command. */
static const uint64_t no_cycle = UINT64_MAX;

int main(int argc, char **argv) {
    const int port = argc > 1 ? atoi(argv[1]) : 5006;
    const double period_s = argc > 2 ? atof(argv[2]) : 5e-4;
    struct sockaddr_in here = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)}, loop;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int link = socket(AF_INET, SOCK_DGRAM, 0);
    if (link < 0 || bind(link, (struct sockaddr *)&here, sizeof here) < 0) {
        perror("machine");
        return 2;
    }
    socklen_t length = sizeof here;
    getsockname(link, (struct sockaddr *)&here, &length);
    printf("machine at 127.0.0.1:%d\n", ntohs(here.sin_port));
    fflush(stdout);
    machine m = {0};
    uint64_t sequence = 1, session = 0, newest = no_cycle;
    time_t heard = 0;
    uint32_t powered = 0;
    for (;;) {
        command_packet in;
        length = sizeof loop;
        const ssize_t came = recvfrom(link, &in, sizeof in, 0, (struct sockaddr *)&loop, &length);
        if (came != sizeof in || memcmp(in.magic, "FFLV", 4) || in.version != 2) continue;
        if (crc32(&in, sizeof in - 4) != in.crc) continue;
        struct timespec now;
        clock_gettime(CLOCK_MONOTONIC, &now);
        if (in.session != session) {
            if (in.kind != 3 || (powered && now.tv_sec - heard < 2)) continue; /* forged, or of another loop than the one that runs */
            session = in.session;
            newest = no_cycle;
        }
        heard = now.tv_sec;
        if (in.kind == 2 && newest != no_cycle && in.cycle <= newest) continue; /* it comes late, or twice */
        if (in.kind == 2) {
            newest = in.cycle;
            powered = in.enable & 1;
            move(&m, in.enable & 1 ? in.command : 0.0, period_s);
            sequence++;
        }
        sample_packet out = {
            .magic = {'F', 'F', 'L', 'V'},
            .version = 2,
            .kind = 1,
            .sequence = sequence,
            .session = session,
            .answers = newest,
            .clock_ns = (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec,
            .force_n = m.force,
            .position_m = m.drive,
            .base_m = m.base,
            .pilot_force_n = 0.0 / 0.0, /* nothing measures it */
            .flags = powered ? 0 : 2,
        };
        out.crc = crc32(&out, sizeof out - 4);
        sendto(link, &out, sizeof out, 0, (struct sockaddr *)&loop, length);
    }
}
