/* The lockstep of shm_protocol: one producer, two consumers, SIGKILL at any step. README.md says what is modelled.

   Every access to a shared word is a step of its own and memory is sequentially consistent (memory_order.pml is about
   weaker memory). A futex word only matters by "has it changed since p read it", so that is what is kept: fresh[p].
   Nobody's sleep times out, except to look whether the peer lives: a lost wake-up is a deadlock. */

#ifndef DEPTH
#define DEPTH 1
#endif
#ifndef SLOTS
#define SLOTS DEPTH
#endif
#ifndef FRAMES
#define FRAMES 3
#endif
#ifndef NO_FINAL
#define NO_FINAL 0 /* 1: the stream ends without a frame marked final */
#endif
#ifndef KILLS
#define KILLS 1
#endif
#ifdef FOLLOWER
#define leads(i) (i == 0) /* consumer 1 follows: the stream does not go on for it alone */
#else
#define leads(i) 1
#endif
#ifndef JOINS
#define JOINS 1 /* how often each consumer entry is used: 2 = again after a goodbye */
#endif

#define PRODUCER 2 /* consumers are 0 and 1 */
#define slot(f) ((f - 1) % SLOTS)
#define max(a, b) ((a) > (b) -> (a) : (b))

mtype = { init_, ready, running, draining, closed, aborted };                         /* ProducerState */
mtype = { free_, joined, left, gave_up };                                              /* ConsumerState */
mtype = { none, ok, attach_timeout, peer_dead, peer_aborted, interrupted };           /* how a process ended */

/* Control page */
mtype producer_state = init_;
byte published;
byte admitted[2];
/* Consumer pages */
mtype consumer_state[2] = free_;
byte acknowledged[2];
/* Slots: 0 = being overwritten, f = holds frame f */
byte sequence[SLOTS];
byte payload[SLOTS];
/* Futex words, waiting flags, sleepers, locks */
bit fresh[3], waiting[3], asleep[3], locked[3];
/* What no process of the protocol can see */
bit killed[3], ended[3];
byte kills;

/* SIGKILL: the kernel drops the lock and takes the process off the futex queue. A process may die before each of its
   stores and in its sleep; a death between two loads is one before the next store. */
#define die(p) die_if(p, true)
#define die_if(p, condition) atomic { kills < KILLS && (condition) -> kills++; killed[p] = 1; ended[p] = 1; locked[p] = 0; asleep[p] = 0; goto dead }
#define mortal(p, store) if :: store :: die(p) fi

/* futex_wake_all on publish_sequence. In one step with the look at the flag: what is woken later is woken for nothing. */
inline wake_consumers() { asleep[0] = 0; asleep[1] = 0 }

/* Publisher::State::ring */
inline ring() {
  mortal(PRODUCER, d_step { fresh[0] = 0; fresh[1] = 0 });
  d_step { if :: waiting[0] -> wake_consumers() :: else fi }
  d_step { if :: waiting[1] -> wake_consumers() :: else fi }
}

/* Link::ring */
inline ring_doorbell() {
  mortal(i, fresh[PRODUCER] = 0);
  d_step { if :: waiting[PRODUCER] -> asleep[PRODUCER] = 0 :: else fi }
}

/* wait.cpp: the kernel compares the word and queues the sleeper in one step */
inline futex_sleep(p) { atomic { if :: fresh[p] -> asleep[p] = 1 :: else fi } }

#include "lockstep_producer.pml"
#include "lockstep_consumer.pml"

init {
  atomic {
    run producer();
    run consumer(0);
    run consumer(1)
  }
}
