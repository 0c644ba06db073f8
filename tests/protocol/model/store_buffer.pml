/* Store buffers: memory that is weaker than sequentially consistent.

   Each process has a store buffer. A relaxed store leaves it at any time, before or after older ones to other words; a
   release store leaves it only when it is the oldest; read-modify-writes, release fences, system calls and sequentially
   consistent stores (which here are always followed by a sequentially consistent load) wait until it is empty. Loads look
   into the own buffer first and are not reordered: a reader's loads that matter are acquire or stronger, or fenced.
   The model that includes this names WORDS and PROCESSES; k is a local byte of each process. */

#define ROOM 4 /* a full buffer waits */

byte memory[WORDS];

typedef Buffer {
  byte used;
  byte word[ROOM];
  byte value[ROOM];
  bit release[ROOM];
}
Buffer buffer[PROCESSES];

inline load(p, w, into) {
  d_step {
    into = memory[w];
    k = 0;
    do
    :: k < buffer[p].used -> if :: buffer[p].word[k] == w -> into = buffer[p].value[k] :: else fi; k++
    :: else -> break
    od;
    k = 0
  }
}

inline store(p, w, v, is_release) {
  d_step {
    buffer[p].used < ROOM ->
    buffer[p].word[buffer[p].used] = w;
    buffer[p].value[buffer[p].used] = v;
    buffer[p].release[buffer[p].used] = is_release;
    buffer[p].used++
  }
}

#define store_relaxed(p, w, v) store(p, w, v, 0)
#define store_release(p, w, v) store(p, w, v, 1)
#define drained(p) (buffer[p].used == 0)

/* One entry leaves a buffer: entry n, unless an older one must go first. */
inline commit(p, n) {
  d_step {
    buffer[p].used > n &&
    (n == 0 || !buffer[p].release[n] && buffer[p].word[n] != buffer[p].word[0] &&
                   (n < 2 || buffer[p].word[n] != buffer[p].word[1]) && (n < 3 || buffer[p].word[n] != buffer[p].word[2])) ->
    memory[buffer[p].word[n]] = buffer[p].value[n];
    k = n;
    do
    :: k + 1 < buffer[p].used ->
       buffer[p].word[k] = buffer[p].word[k + 1];
       buffer[p].value[k] = buffer[p].value[k + 1];
       buffer[p].release[k] = buffer[p].release[k + 1];
       k++
    :: else -> break
    od;
    buffer[p].used--;
    buffer[p].word[buffer[p].used] = 0;
    buffer[p].value[buffer[p].used] = 0;
    buffer[p].release[buffer[p].used] = 0;
    k = 0
  }
}

proctype store_unit(byte p) {
  byte k;
end:
  do
  :: commit(p, 0)
  :: commit(p, 1)
  :: commit(p, 2)
  :: commit(p, 3)
  od
}
