/* A line that can be cut, between a live loop and its machine: passes packets on, of one loop and one machine.
 *
 *     relay PORT_OF_THE_MACHINE
 *
 * On its input: "cut 300" loses all for so many ms. In their middle what it kept of the samples before comes late, the last first and each
 * twice.
 */
#include <arpa/inet.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { KEPT = 64, LONGEST = 128 };

static int bound(struct sockaddr_in *at) {
    const int one = socket(AF_INET, SOCK_DGRAM, 0);
    *at = (struct sockaddr_in){.sin_family = AF_INET};
    at->sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (one < 0 || bind(one, (struct sockaddr *)at, sizeof *at) < 0) {
        perror("relay");
        exit(2);
    }
    socklen_t length = sizeof *at;
    getsockname(one, (struct sockaddr *)at, &length);
    return one;
}

static double now_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

int main(int argc, char **argv) {
    if (argc != 2) return 2;
    struct sockaddr_in here, there, loop = {0};
    const int front = bound(&here), back = bound(&there);
    there.sin_port = htons((uint16_t)atoi(argv[1]));
    if (connect(back, (struct sockaddr *)&there, sizeof there) < 0) return 2;
    printf("relay at 127.0.0.1:%d\n", ntohs(here.sin_port));
    fflush(stdout);

    char kept[KEPT][LONGEST], line[64];
    ssize_t lengths[KEPT] = {0};
    unsigned long passed = 0;
    double until = 0, late = 0; /* the cut's end, and when old samples come; 0 where there is none */
    struct pollfd from[] = {{front, POLLIN, 0}, {back, POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
    for (;;) {
        poll(from, 3, 1);
        char packet[LONGEST];
        if (from[0].revents & POLLIN) {
            socklen_t length = sizeof loop;
            const ssize_t count = recvfrom(front, packet, sizeof packet, 0, (struct sockaddr *)&loop, &length);
            if (count > 0 && until == 0) send(back, packet, (size_t)count, 0);
        }
        if (from[1].revents & POLLIN) {
            const ssize_t count = recv(back, packet, sizeof packet, 0);
            if (count > 0 && until == 0) {
                sendto(front, packet, (size_t)count, 0, (struct sockaddr *)&loop, sizeof loop);
                memcpy(kept[passed % KEPT], packet, (size_t)count);
                lengths[passed++ % KEPT] = count;
            }
        }
        if (from[2].revents & (POLLIN | POLLHUP)) {
            const ssize_t count = read(STDIN_FILENO, line, sizeof line - 1);
            if (count <= 0) return 0;
            line[count] = 0;
            double lasts = 0;
            if (sscanf(line, "cut %lf", &lasts) == 1) {
                late = now_ms() + lasts / 2;
                until = now_ms() + lasts;
            }
        }
        if (until != 0 && now_ms() >= until) until = 0;
        if (late != 0 && now_ms() >= late) {
            for (unsigned long back_to = 1; back_to <= KEPT && back_to <= passed; back_to++)
                for (int twice = 0; twice < 2; twice++) {
                    const unsigned long k = (passed - back_to) % KEPT;
                    sendto(front, kept[k], (size_t)lengths[k], 0, (struct sockaddr *)&loop, sizeof loop);
                }
            late = 0;
        }
    }
}
