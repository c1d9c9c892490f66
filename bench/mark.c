/* A mark for stepper.c: begin and end of a region in turn. */
void bench_mark(void) { __asm__ volatile("int3"); }
