/* A fuzzer in one file: random changes of good inputs, kept when they reach code that no input reached before.
 *
 *   fuzz scene|restart|abi [--runs N] [--seed S] [--out FOLDER] [--only K] [FILE...]
 *
 * The files are the first corpus (scenes; for `restart` scenes too, whose restart files are made first); FILE replayed alone with
 * --runs 0. Inputs run in a child process; one that ends it (a sanitizer, a signal, five seconds of work without an answer) is kept as
 * FOLDER/crash-N and the next child goes on. The last line says how many inputs ran, how many crashed; exit code 1 if any did.
 *
 * Which code an input reaches is counted where the library was compiled with gcc's -fsanitize-coverage=trace-pc; without it the
 * changes are blind, and all else is the same. */
#define _GNU_SOURCE
#include "fuzz.h"
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

enum { edges = 1 << 16, most_inputs = 4096, longest = 16384, seconds_each = 5 };

struct shared {
  unsigned long runs, answers[16], broken;
  uint64_t random;
  int inputs, reached, crashes;
  size_t length;
  unsigned char current[longest], seen[edges];
  struct {
    size_t length;
    unsigned char bytes[longest];
  } corpus[most_inputs];
};
static struct shared *s;
static unsigned char hits[edges];
static char folder[200], restart[240];
static const char *target;

/* gcc calls this at every edge of the program. */
__attribute__((no_sanitize_address, no_sanitize_undefined)) void __sanitizer_cov_trace_pc(void) {
  uintptr_t at = (uintptr_t)__builtin_return_address(0);
  hits[(at ^ (at >> 16)) & (edges - 1)] = 1;
}

uint64_t fuzz_random(void) { /* xorshift64* */
  s->random ^= s->random >> 12;
  s->random ^= s->random << 25;
  s->random ^= s->random >> 27;
  return s->random * 2685821657736338717ULL;
}
size_t fuzz_below(size_t n) { return n ? (size_t)((fuzz_random() >> 11) % n) : 0; }

/* ---- changes ------------------------------------------------------------------------------------------------------- */

static const char *const words[] = {
    "&", "/", "=", ",", "'", "\"", "!", "(", ")", "*", "\n", "\r", "\r\n", "\t", " ", "3*", "3*0.0", "100000000*", ",,,", "&end",
    "&scene", "&bodies", "&output", "&gravity", "&field", "&gravity_gradient", "&spring", "&torque", "&drag", "&langevin",
    "&gyrostat", "&dipoles", "&potential", "u", "constants", "'k*(1 - Q33)^2'", "'k=2'", "moments", "tensor", "shape", "y", "omega", "q", "count", "random", "temperature", "h", "t_end",
    "method", "splitting", "tol", "seed", "threads", "every", "times", "bodies", "format", "restart", "pictures", "class",
    "centre", "weight", "up", "'exact'", "'dmv10'", "'auto'", "'jacobi'", "'strang'", "'omelyan8'", "'uniform'", "'thermal'",
    "(1)", "(2)", "(100000000)", "(0)", "(-1)", ".true.", "\xef\xbb\xbf", "\xc3\xa9", "\x00", "\x7f", "\xff", "''", "''''"};
static const char *const numbers[] = {
    "0", "-0", "1", "-1", "2", "0.5", "1e-300", "1e300", "1e307", "1.8e308", "1e400", "-1e300", "4.9e-324", "2.2250738585072014e-308",
    "nan", "inf", "1d5", "1e", "e5", "+", "-", ".", "1.", ".1", "1..", "2147483647", "2147483648", "-2147483648", "4294967296",
    "9223372036854775807", "9223372036854775808", "1e15", "1e-15", "1e-7", "1000001", "40", "3", "0x10", "1_8", "1e+9", "1e-12",
    "0000000000000000", "7FF0000000000000", "7FF8000000000000", "FFF0000000000000", "0000000000000001", "3FF0000000000000"};

static size_t splice(unsigned char *x, size_t n, size_t at, size_t gone, const void *more, size_t m) {
  unsigned char tail[longest];
  size_t left = n - at - gone;
  if (at + m + left > longest) return n;
  memcpy(tail, x + at + gone, left);
  memcpy(x + at, more, m);
  memcpy(x + at + m, tail, left);
  return at + m + left;
}

/* Another number in the place of one that is there. */
static size_t renumber(unsigned char *x, size_t n) {
  size_t at = fuzz_below(n), end;
  const char *w = numbers[fuzz_below(sizeof numbers / sizeof *numbers)];
  while (at < n && !strchr("0123456789", x[at])) at++;
  if (at >= n) return n;
  while (at > 0 && x[at - 1] && strchr("0123456789.eE+-", x[at - 1])) at--;
  for (end = at; end < n && x[end] && strchr("0123456789ABCDEF.eE+-", x[end]);) end++;
  return splice(x, n, at, end - at, w, strlen(w));
}

static size_t change(unsigned char *x, size_t n) {
  size_t at = fuzz_below(n + 1), m, k;
  const char *w;
  unsigned char piece[256], byte;
  switch (fuzz_below(11)) {
  case 0: if (n) x[fuzz_below(n)] ^= 1u << fuzz_below(8); return n;
  case 1: if (n) x[fuzz_below(n)] = fuzz_random(); return n;
  case 2: byte = fuzz_random(); return splice(x, n, at, 0, &byte, 1);
  case 3: m = fuzz_below(1 + (n - at < 64 ? n - at : 64)); return splice(x, n, at, m, "", 0);
  case 4: /* a piece twice */
    m = fuzz_below(1 + (n - at < sizeof piece ? n - at : sizeof piece));
    memcpy(piece, x + at, m);
    return splice(x, n, fuzz_below(n + 1), 0, piece, m);
  case 5: /* a piece of another input */
    k = fuzz_below(s->inputs);
    m = fuzz_below(1 + (s->corpus[k].length < sizeof piece ? s->corpus[k].length : sizeof piece));
    memcpy(piece, s->corpus[k].bytes + fuzz_below(s->corpus[k].length - m + 1), m);
    return splice(x, n, at, 0, piece, m);
  case 6: return fuzz_below(8) ? n : at; /* cut */
  case 7:
  case 8: w = words[fuzz_below(sizeof words / sizeof *words)]; return splice(x, n, at, 0, w, strlen(w));
  default: return renumber(x, n);
  }
}

/* The sum at the end of a restart file made right again, so that what it guards is reached. */
static size_t mend(unsigned char *x, size_t n) {
  uint64_t sum = 0, t = 0, h = 0, tolerance = 0, step = 0, seed = 0;
  char text[longest + 1], *line, *next, end[32];
  int head = 1; /* behind the line "bodies" come their states */
  memcpy(text, x, n);
  text[n] = 0;
  for (line = text; line && *line; line = next) {
    next = strchr(line, '\n');
    if (next) *next++ = 0;
    if (head) {
      if (strncmp(line, "t ", 2) == 0) t = strtoull(line + 2, NULL, 16);
      if (strncmp(line, "h ", 2) == 0) h = strtoull(line + 2, NULL, 16);
      if (strncmp(line, "tolerance ", 10) == 0) tolerance = strtoull(line + 10, NULL, 16); /* since version 2 */
      if (strncmp(line, "step ", 5) == 0) step = strtoll(line + 5, NULL, 10);
      if (strncmp(line, "seed ", 5) == 0) seed = strtoll(line + 5, NULL, 10);
      if (strncmp(line, "bodies ", 7) != 0) continue;
      head = 0;
      sum = step ^ (seed << 32 | seed >> 32);
      sum = (sum << 5 | sum >> 59) ^ t;
      sum = (sum << 5 | sum >> 59) ^ h;
      if ((int64_t)tolerance > 0) sum = (sum << 5 | sum >> 59) ^ tolerance;
      continue;
    }
    if (strncmp(line, "end ", 4) == 0) {
      snprintf(end, sizeof end, "end %016llX\n", (unsigned long long)sum);
      return splice(x, n, (size_t)(line - text), n - (size_t)(line - text), end, strlen(end));
    }
    {
      char *p = line, *q;
      for (;; p = q) {
        uint64_t v = strtoull(p, &q, 16);
        if (p == q) break;
        sum = (sum << 5 | sum >> 59) ^ v;
      }
    }
  }
  return n;
}

/* ---- one input ----------------------------------------------------------------------------------------------------- */

static int scene_answer(const unsigned char *x, size_t n) {
  return fuzz_scene(x, n, folder, strlen(folder), s->runs % 4 == 0 || n < 400);
}

/* An input for `restart`: a scene, a zero byte, a restart file. */
static int restart_answer(const unsigned char *x, size_t n) {
  const unsigned char *cut = memchr(x, 0, n);
  FILE *f;
  if (!cut) return 0;
  f = fopen(restart, "w");
  if (!f) abort();
  fwrite(cut + 1, 1, (size_t)(x + n - cut - 1), f);
  fclose(f);
  return fuzz_restart(x, (size_t)(cut - x), restart, strlen(restart), folder, strlen(folder));
}

static int run_one(const unsigned char *x, size_t n) {
  struct itimerval limit = {{0, 0}, {seconds_each, 0}};
  int answer, k, new = 0;
  unsigned char *copy = malloc(n ? n : 1); /* of its own size, so that a read past its end is seen */
  memcpy(copy, x, n);
  memset(hits, 0, sizeof hits);
  setitimer(ITIMER_PROF, &limit, NULL);
  if (strcmp(target, "scene") == 0) answer = scene_answer(copy, n);
  else if (strcmp(target, "restart") == 0) answer = restart_answer(copy, n);
  else answer = fuzz_abi(copy, n);
  limit.it_value.tv_sec = 0;
  setitimer(ITIMER_PROF, &limit, NULL);
  free(copy);
  if (answer < 0 || answer > 15) abort(); /* a broken promise is a crash */
  s->answers[answer]++;
  s->runs++;
  for (k = 0; k < edges; k++)
    if (hits[k] && !s->seen[k]) s->seen[k] = 1, s->reached++, new = 1;
  return new;
}

static void keep(const unsigned char *x, size_t n) {
  int k = s->inputs < most_inputs ? s->inputs++ : (int)fuzz_below(most_inputs);
  memcpy(s->corpus[k].bytes, x, n);
  s->corpus[k].length = n;
}

static void child(unsigned long last) {
  while (s->runs < last) {
    size_t k, n, first = strcmp(target, "restart") ? 0 : 1;
    k = fuzz_below(s->inputs);
    n = s->corpus[k].length;
    memcpy(s->current, s->corpus[k].bytes, n);
    for (k = 1 + fuzz_below(1 + fuzz_below(8)); k > 0; k--) {
      unsigned char *cut = first && fuzz_below(8) ? memchr(s->current, 0, n) : NULL;
      size_t head = cut ? (size_t)(cut + 1 - s->current) : 0;
      n = head + change(s->current + head, n - head); /* mostly the restart file, now and then the scene */
      if (n > longest - 256) n = longest - 256;
      if (cut && fuzz_below(2)) n = head + mend(s->current + head, n - head);
    }
    s->length = n;
    if (run_one(s->current, n)) keep(s->current, n);
  }
  _exit(0);
}

/* ---- the first corpus ---------------------------------------------------------------------------------------------- */

static void take(const char *path) {
  unsigned char x[longest];
  size_t n;
  FILE *f = fopen(path, "rb");
  if (!f) {
    fprintf(stderr, "fuzz: cannot read %s\n", path);
    exit(2);
  }
  n = fread(x, 1, longest - 4096, f);
  fclose(f);
  keep(x, n);
}

/* A scene for restarts, and the restart file that its run leaves. */
static void take_restart(void) {
  static const char *const scenes[] = {
      "&scene t_end = 2, h = 0.1 /\n&bodies count = 2, moments = 0.6, 0.8, 1, y = 1, 0.1, 0.2, random = 'uniform' /\n"
      "&output every = 1, restart = 'restart.txt' /\n",
      "&scene t_end = 2, h = 0.1, splitting = 'omelyan4' /\n&bodies moments = 0.6, 0.6, 0, y = 1, 0.1, 0 /\n"
      "&gravity centre = 0, 0, 1 /\n&output every = 1, restart = 'restart.txt' /\n"};
  unsigned char x[longest];
  char path[300];
  size_t i, n, m;
  for (i = 0; i < 2; i++) {
    char early[400], *t = early;
    FILE *f;
    strcpy(early, scenes[i]);
    t = strstr(early, "t_end = 2");
    t[8] = '1'; /* the run that leaves the file ends earlier */
    if (fuzz_scene((const unsigned char *)early, strlen(early), folder, strlen(folder), 1) != 0) exit(2);
    snprintf(path, sizeof path, "%s/restart.txt", folder);
    f = fopen(path, "rb");
    if (!f) exit(2);
    n = strlen(scenes[i]);
    memcpy(x, scenes[i], n + 1);
    m = fread(x + n + 1, 1, longest - 4096, f);
    fclose(f);
    if (restart_answer(x, n + 1 + m) != 0) {
      fprintf(stderr, "fuzz: the first restart file is not taken\n");
      exit(2);
    }
    if (mend(x + n + 1, m) != m || restart_answer(x, n + 1 + m) != 0) {
      fprintf(stderr, "fuzz: the sum of a restart file is not what this program thinks\n");
      exit(2);
    }
    keep(x, n + 1 + m);
  }
}

static void save(const char *out, int status) {
  char path[300];
  FILE *f;
  snprintf(path, sizeof path, "%s/crash-%s-%d", out, target, s->crashes);
  f = fopen(path, "wb");
  if (f) {
    fwrite(s->current, 1, s->length, f);
    fclose(f);
  }
  fprintf(stderr, "fuzz: %s after %lu inputs: kept as %s\n",
          WIFSIGNALED(status) && WTERMSIG(status) == SIGPROF ? "no answer" : "a crash", s->runs, path);
}

int main(int argc, char **argv) {
  unsigned long runs = 10000;
  const char *out = ".";
  int i, replay = 0, files = 0;
  if (argc < 2) {
    fprintf(stderr, "usage: fuzz scene|restart|abi [--runs N] [--seed S] [--out FOLDER] [FILE...]\n");
    return 2;
  }
  target = argv[1];
  s = mmap(NULL, sizeof *s, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (s == MAP_FAILED) return 2;
  s->random = 88172645463325252ULL;
  for (i = 2; i < argc; i++) {
    if (strcmp(argv[i], "--runs") == 0 && i + 1 < argc) runs = strtoul(argv[++i], NULL, 10), replay = runs == 0;
    else if (strcmp(argv[i], "--seed") == 0 && i + 1 < argc) s->random += 7919 * strtoull(argv[++i], NULL, 10);
    else if (strcmp(argv[i], "--out") == 0 && i + 1 < argc) out = argv[++i];
    else take(argv[i]), files++;
  }
  mkdir(out, 0777);
  snprintf(folder, sizeof folder, "%s/run-%s", out, target);
  snprintf(restart, sizeof restart, "%s/restart-%s.txt", out, target);
  if (strcmp(target, "abi") == 0 && !files) {
    unsigned char x[2048];
    size_t k;
    for (i = 0; i < 32; i++) {
      for (k = 0; k < sizeof x; k++) x[k] = (unsigned char)fuzz_random();
      keep(x, sizeof x);
    }
  }
  if (strcmp(target, "restart") == 0 && !replay) {
    s->inputs = 0;
    take_restart();
  }
  if (replay) {
    for (i = 0; i < s->inputs; i++) run_one(s->corpus[i].bytes, s->corpus[i].length);
    printf("%d inputs replayed\n", s->inputs);
    return 0;
  }
  while (s->runs < runs && s->crashes < 50) {
    int status;
    pid_t pid = fork();
    if (pid < 0) return 2;
    if (pid == 0) child(runs);
    waitpid(pid, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) continue;
    save(out, status);
    s->crashes++;
    s->runs++;
  }
  printf("fuzz %s: answers", target);
  for (i = 0; i < 16; i++)
    if (s->answers[i]) printf(" %d:%lu", i, s->answers[i]);
  printf("; %d edges reached, %d inputs kept\n", s->reached, s->inputs);
  printf("fuzz %s: %lu inputs, %d crashes\n", target, s->runs, s->crashes);
  return s->crashes > 0;
}
