/* LATEST mode: a producer that never waits, a reader that copies out the newest frame and looks whether it was
   overtaken, over weak memory. README.md says what is modelled. */

#ifndef FRAMES
#define FRAMES 4
#endif
#ifndef SLOTS
#define SLOTS 2
#endif
#define slot(f) ((f - 1) % SLOTS)

#define PRODUCER 0
#define READER 1

/* Words of the segment; a frame is two words of payload, each holding its number */
#define PUBLISHED 0
#define STATE 1 /* 1 = draining */
#define SEQUENCE(f) (2 + slot(f))
#define FIRST(f) (2 + SLOTS + slot(f))
#define SECOND(f) (2 + 2 * SLOTS + slot(f))
#define WORDS (2 + 3 * SLOTS)
#define PROCESSES 1 /* the reader stores nothing that anybody waits for */
#include "store_buffer.pml"

byte publications; /* futex word */
byte acknowledged;   /* ConsumerEntry.acknowledged_frame: for onlookers, the producer never waits for it */
bit reader_waiting, reader_asleep;

/* Publisher::State::ring */
inline ring() {
  d_step { drained(PRODUCER) -> publications++ }
  atomic { if :: reader_waiting -> reader_asleep = 0 :: else fi }
}

proctype producer() {
  byte frame = 1, k;
  do
  :: frame <= FRAMES ->
#ifdef PRODUCER_WAITS
     acknowledged == frame - 1;
#endif
     /* begin_frame: store_ordered, fence_release */
#ifndef NOT_MARKED_ODD
     store_release(PRODUCER, SEQUENCE(frame), 2 * frame - 1);
#ifndef NO_WRITER_FENCE
     drained(PRODUCER);
#endif
#endif
#ifdef PUBLISHED_BEFORE_PAYLOAD
     store_release(PRODUCER, SEQUENCE(frame), 2 * frame);
     store_release(PRODUCER, PUBLISHED, frame);
     store_relaxed(PRODUCER, FIRST(frame), frame);
     store_relaxed(PRODUCER, SECOND(frame), frame);
#else
     store_relaxed(PRODUCER, FIRST(frame), frame);
     store_relaxed(PRODUCER, SECOND(frame), frame);
     /* end_frame */
     store_release(PRODUCER, SEQUENCE(frame), 2 * frame);
     store_release(PRODUCER, PUBLISHED, frame);
#endif
     if
     :: frame == FRAMES -> store_release(PRODUCER, STATE, 1)
     :: else
     fi;
     ring();
     frame++
  :: else -> break
  od
}

#define recall(w, into) into = memory[w]

/* LatestReader::State::look, take_newest, take: `taken` is a frame that is whole, or 0 */
inline look() {
  recall(STATE, state);
  recall(PUBLISHED, newest);
  if
  :: newest > last ->
     recall(SEQUENCE(newest), before);
     recall(FIRST(newest), first);
#ifdef NO_READER_FENCE
     recall(SEQUENCE(newest), after); /* loaded too early */
     recall(SECOND(newest), second);
#else
     recall(SECOND(newest), second);
     recall(SEQUENCE(newest), after);
#endif
     d_step {
       if
#ifdef NOT_CHECKED_AGAIN
       :: before == 2 * newest -> taken = newest
#else
       :: before == 2 * newest && after == 2 * newest -> taken = newest
#endif
       :: else -> taken = 0
       fi;
       before = 0;
       after = 0
     }
  :: else
  fi
}

proctype reader() {
  byte last, newest, before, after, first, second, seen, taken;
  bit state;
  do
  :: /* next: one of the looks before the sleep */
     look();
     if
     :: taken
     :: else ->
        reader_waiting = 1;
        do
        :: seen = publications;
           look();
           if :: taken || state -> break :: else fi;
           atomic { if :: publications == seen -> reader_asleep = 1 :: else fi }
           !reader_asleep
        od;
        reader_waiting = 0
     fi;
     if
     :: taken ->
        d_step {
          assert(first == taken && second == taken); /* complete */
          assert(taken > last);                      /* newer than the one before */
          last = taken;
          acknowledged = taken;
          taken = 0; first = 0; second = 0; newest = 0; seen = 0
        }
     :: else ->
        assert(last == FRAMES); /* the last frame is not missed */
        break
     fi
  :: break /* it may die or stop reading */
  od
}

init {
  atomic {
    run producer();
    run reader();
    run store_unit(PRODUCER)
  }
}
