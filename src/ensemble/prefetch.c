/* Asks for memory that a block soon needs, so that it is there when the block before has been computed: Fortran has no word for
 * it. Nothing is read; an address where nothing is does no harm. */
void poinsot_prefetch(const char *from, long long bytes);

void poinsot_prefetch(const char *from, long long bytes)
{
#ifdef __GNUC__
    long long at;
    for (at = 0; at < bytes; at += 64) __builtin_prefetch(from + at, 0, 2);
#else
    (void)from, (void)bytes;
#endif
}
