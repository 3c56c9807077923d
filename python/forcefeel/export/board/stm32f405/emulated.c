/* In place of inputs.c under QEMU: the golden vectors are the inputs, and the answers are held against them. */
#include "board.h"
#include BOARD_GOLDEN

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#ifndef FAULT_AT
#define FAULT_AT GOLDEN /* the period in which an undefined instruction comes */
#endif

void initialise_monitor_handles(void);
static uint32_t next, wrong;

void clock_begin(void)
{
    initialise_monitor_handles();
}

void inputs_begin(void) { }

static void compare(const forcefeel_output *o, uint32_t k)
{
    const float *const must = golden_out[k];
    const uint32_t *const state = golden_state[k];
    wrong += (o->command != must[0]) || (o->torque != must[1]) || (o->feel[0] != must[2]) || (o->feel[1] != must[3])
        || (o->enable != state[0]) || (o->state != state[1]) || (o->acting != state[2]) || (o->tripped != state[3]);
}

static void finish(int status)
{
    (void)printf("%s: %u samples, %u differ; stack %u of %u bytes\n", BOARD_NAME, (unsigned)next, (unsigned)wrong,
        (unsigned)(stack_bytes() - stack_never_used()), (unsigned)stack_bytes());
    (void)fflush(stdout);
    _exit(status);
}

void read_inputs(forcefeel_input *in)
{
    if (next > 0U) {
        compare(&board_output, next - 1U);
    }
    if (next == GOLDEN) {
        finish((wrong == 0U) ? 0 : 1);
    }
    if (next == FAULT_AT) {
        __asm volatile("udf #0");
    }
    (void)memcpy(in->sensors, golden_in[next], sizeof in->sensors);
    (void)memcpy(&in->trim, golden_in[next] + 4, 7U * sizeof in->trim);
    const unsigned char *const words = golden_words[next];
    in->from = words[0];
    in->to = words[1];
    in->request = words[2];
    in->missed = words[3];
    in->delay = words[4];
    in->late = words[5];
    in->flags = words[6];
    ++next;
}

void stopped(void)
{
    finish(3);
    for (;;) {
    }
}
