/* One producer and one consumer of the lockstep over weak memory. README.md says what is modelled. */

#ifndef FRAMES
#define FRAMES 2
#endif
#ifndef DEPTH
#define DEPTH 1
#endif
#ifndef SLOTS
#define SLOTS DEPTH
#endif
#define slot(f) ((f - 1) % SLOTS)

#define PRODUCER 0
#define CONSUMER 1

/* Words of the segment */
#define PUBLISHED 0
#define ACKNOWLEDGED 1
#define PRODUCER_WAITING 2
#define CONSUMER_WAITING 3
#define PUBLISH_SEQUENCE 4
#define CONSUMER_SEQUENCE 5
#define SEQUENCE(f) (6 + slot(f))
#define PAYLOAD(f) (6 + SLOTS + slot(f))
#define WORDS (6 + 2 * SLOTS)
#define PROCESSES 2
#include "store_buffer.pml"

bit asleep[2];

/* count_up (a read-modify-write), then the look at the other side's flag, then the system call */
inline ring(p, word, flag, sleeper) {
#ifdef COUNTED_BY_A_RELEASE_STORE
  load(p, word, seen);
  store_release(p, word, seen + 1);
#else
  d_step { drained(p) -> memory[word] = memory[word] + 1 }
#endif
  load(p, flag, seen);
  if
  :: seen -> atomic { drained(p) -> asleep[sleeper] = 0 }
  :: else
  fi;
  seen = 0
}

/* wait.cpp: flag, word, news, sleep */
inline wait(p, word, flag, news, at_least) {
  load(p, news, got);
  if
  :: got >= at_least
  :: else ->
#ifdef FLAG_BY_A_RELEASE_STORE
     store_release(p, flag, 1);
#else
     store_release(p, flag, 1);
     drained(p); /* store_ordered */
#endif
     do
     :: load(p, word, seen);
        load(p, news, got);
        if :: got >= at_least -> break :: else fi;
        /* The kernel reads memory; entering it drains nothing by itself. */
        atomic { if :: memory[word] == seen -> asleep[p] = 1 :: else fi }
        !asleep[p]
     od;
     store_relaxed(p, flag, 0)
  fi;
  d_step { seen = 0; got = 0 }
}

proctype producer() {
  byte frame = 1, seen, got, k;
  do
  :: frame <= FRAMES ->
     if
     :: frame > DEPTH -> wait(PRODUCER, CONSUMER_SEQUENCE, PRODUCER_WAITING, ACKNOWLEDGED, frame - DEPTH)
     :: else
     fi;
     store_release(PRODUCER, SEQUENCE(frame), 2 * frame - 1);
     store_relaxed(PRODUCER, PAYLOAD(frame), 0); /* being written */
     store_relaxed(PRODUCER, PAYLOAD(frame), frame);
#ifdef SEQUENCE_RELAXED
     store_relaxed(PRODUCER, SEQUENCE(frame), 2 * frame);
     store_relaxed(PRODUCER, PUBLISHED, frame);
#else
#ifdef PUBLISHED_RELAXED
     store_release(PRODUCER, SEQUENCE(frame), 2 * frame);
     store_relaxed(PRODUCER, PUBLISHED, frame);
#else
     store_release(PRODUCER, SEQUENCE(frame), 2 * frame);
     store_release(PRODUCER, PUBLISHED, frame);
#endif
#endif
     ring(PRODUCER, PUBLISH_SEQUENCE, CONSUMER_WAITING, CONSUMER);
     frame++
  :: else -> break
  od
}

proctype consumer() {
  byte frame = 1, seen, got, k;
  do
  :: frame <= FRAMES ->
     wait(CONSUMER, PUBLISH_SEQUENCE, CONSUMER_WAITING, PUBLISHED, frame);
     load(CONSUMER, SEQUENCE(frame), got);
     assert(got == 2 * frame);
     load(CONSUMER, PAYLOAD(frame), got);
     assert(got == frame);
     load(CONSUMER, PAYLOAD(frame), got);
     assert(got == frame);
     store_release(CONSUMER, ACKNOWLEDGED, frame);
     ring(CONSUMER, CONSUMER_SEQUENCE, PRODUCER_WAITING, PRODUCER);
     frame++
  :: else -> break
  od
}

init {
  atomic {
    run producer();
    run consumer();
    run store_unit(PRODUCER);
    run store_unit(CONSUMER)
  }
}
