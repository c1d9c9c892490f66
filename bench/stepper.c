/* Counts the instructions that a program executes, where no performance counters are at hand (virtual machines): the program is
 * single-stepped between marks. Linux on x86-64 only.
 *
 * usage: stepper PROGRAM [ARGUMENTS]
 * The program marks the begin and the end of a region by executing int3, in turn. For region k = 0, 1, ... lines
 * "k address count" are written to standard output, one for each instruction that was executed, address in hexadecimal.
 */
#define _GNU_SOURCE
#include <sched.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/ptrace.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#define SLOTS (1u << 20)

static unsigned long address[SLOTS], count[SLOTS];

static void add(unsigned long where)
{
    unsigned slot = (unsigned)(where * 0x9E3779B97F4A7C15ul >> 44);
    while (count[slot] && address[slot] != where) slot = (slot + 1) % SLOTS;
    address[slot] = where;
    count[slot]++;
}

static void write_region(long region)
{
    for (unsigned slot = 0; slot < SLOTS; slot++)
        if (count[slot]) printf("%ld %lx %lu\n", region, address[slot], count[slot]);
    for (unsigned slot = 0; slot < SLOTS; slot++) count[slot] = 0;
}

int main(int argc, char **argv)
{
    int status, inside = 0;
    long region = 0;
    unsigned long mark = 0, here, before = 0;
    pid_t child;
    cpu_set_t one;

    if (argc < 2) return 2;
    CPU_ZERO(&one);
    CPU_SET(sched_getcpu(), &one);
    sched_setaffinity(0, sizeof one, &one);     /* both on one processor: changing between them is quicker */
    child = fork();
    if (child < 0) return 1;
    if (child == 0) {
        if (ptrace(PTRACE_TRACEME, 0, 0, 0) != 0) _exit(126);
        execv(argv[1], argv + 1);
        _exit(127);
    }
    if (waitpid(child, &status, 0) < 0 || !WIFSTOPPED(status)) return 1;
    ptrace(PTRACE_SETOPTIONS, child, 0, PTRACE_O_EXITKILL);
    for (;;) {
        if (ptrace(inside ? PTRACE_SINGLESTEP : PTRACE_CONT, child, 0, 0) != 0) return 1;
        if (waitpid(child, &status, 0) < 0) return 1;
        if (WIFEXITED(status)) return WEXITSTATUS(status);
        if (!WIFSTOPPED(status) || WSTOPSIG(status) != SIGTRAP) {
            fprintf(stderr, "stepper: the program stopped in region %ld\n", region);
            return 1;
        }
        here = (unsigned long)ptrace(PTRACE_PEEKUSER, child, offsetof(struct user_regs_struct, rip), 0);
        if (!inside) {
            mark = here - 1;                    /* the trap leaves us behind the mark */
            inside = 1;
        } else if (here == mark) {
            ptrace(PTRACE_POKEUSER, child, offsetof(struct user_regs_struct, rip), here + 1);
            write_region(region++);
            inside = 0;
        } else if (here != before) {            /* a repeated string instruction is one instruction */
            add(here);
        }
        before = here;
    }
}
