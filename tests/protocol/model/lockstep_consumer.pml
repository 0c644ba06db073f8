/* attach.cpp, subscriber.cpp, subscriber_state.cpp. Part of lockstep.pml. */

mtype = { open, complete, over, failed }; /* Subscriber::State::Outlook */

/* Subscriber::State::look: the state is read before published_frame */
inline look() {
#ifdef STATE_READ_LAST
  there = published;
#else
  state = producer_state;
#endif
  if
#ifdef ADMITS_ITSELF
  :: next == 0 -> next = published + 1
#else
  :: next == 0 -> next = admitted[i]
#endif
  :: else
  fi;
#ifdef STATE_READ_LAST
  state = producer_state;
#else
  there = published;
#endif
  d_step {
    if
    :: next != 0 && there >= next -> assert(there - next < DEPTH); outlook = complete
    :: else ->
       if
       :: state == aborted -> outlook = failed
       :: state == draining || state == closed -> outlook = over
       :: else -> outlook = open
       fi
    fi;
    there = 0
  }
}

/* Subscriber::State::wait_for_next; a slice finds a dead producer */
inline wait_for_next() {
  look();
  if
  :: outlook != open
  :: else ->
#ifndef NO_CONSUMER_FLAG
     mortal(i, waiting[i] = 1);
#endif
     do
#ifdef WORD_READ_LAST
     :: look();
        fresh[i] = 1;
#else
     :: fresh[i] = 1;
        look();
#endif
        if :: outlook != open -> break :: else fi;
        looked = 0;
        futex_sleep(i);
        do
        :: !asleep[i] -> break
        :: die(i)
#ifndef NO_CONSUMER_LIVENESS
        :: asleep[i] && killed[PRODUCER] && !looked ->
           looked = 1;
           look();
           if :: outlook == open -> outcome = peer_dead; goto abort :: else -> asleep[i] = 0; break fi
#endif
#ifdef ABORTS
        :: asleep[i] -> outcome = interrupted; goto abort
#endif
        od
     od;
     mortal(i, waiting[i] = 0)
  fi
}

inline forget_consumer() { d_step { next = 0; there = 0; looked = 0; state = 0; outlook = 0 } }

#ifdef ENTRIES_REST
/* An entry is used again only after a frame was published since its goodbye. */
byte left_at[2];
#define rested(i, frames) (joins == 0 || frames > left_at[i])
#else
#define rested(i, frames) 1
#endif

/* attach.cpp:is_free, with a step for each load that another process can change under it */
inline claim_entry() {
  locked[i] = 1;
#ifdef ADMITTED_READ_FIRST
  there = admitted[i];
  if
  :: there == 0 && rested(i, published)
  :: else -> there = 0; locked[i] = 0; ring_doorbell(); goto attach
  fi;
#else
  if
  :: joins == 0 /* it is free, not left: published_frame is not looked at */
  :: else -> there = published
  fi;
  if
  :: rested(i, there) && admitted[i] == 0
  :: else -> there = 0; locked[i] = 0; ring_doorbell(); goto attach
  fi;
#endif
  there = 0
}

proctype consumer(byte i) {
  byte next, there, joins;
  bit looked;
  mtype state, outlook, outcome = none;
  attach: /* attach.cpp: tries until its entry is free, the producer dead or the stream over */
    if
    :: ended[PRODUCER] || producer_state == draining || producer_state == closed || producer_state == aborted ->
       outcome = attach_timeout;
       goto gone
    :: locked[PRODUCER] && producer_state != init_ -> claim_entry()
#ifdef ENTRIES_REST
    :: joins > 0 && left_at[i] >= published -> outcome = attach_timeout; goto gone
#endif
    fi;
    mortal(i, acknowledged[i] = 0);
    mortal(i, consumer_state[i] = joined);
    ring_doorbell();
    joins++;

    /* acquire, release */
    do
#ifdef LEAVES
    :: goto leave
#endif
#ifdef ABORTS
    :: outcome = interrupted; goto abort
#endif
    :: wait_for_next();
       if
       :: outlook == over ->
          if
          :: next == 0 -> outcome = attach_timeout; goto abort
          :: else ->
             assert(next == published + 1);
             goto leave
          fi
       :: outlook == failed -> outcome = peer_aborted; goto abort
       :: else
       fi;
       /* check_frame: the frame is in use from here ... */
       atomic { assert(sequence[slot(next)] == 2 * next); assert(payload[slot(next)] == next) }
#ifdef ACKNOWLEDGED_FIRST
       mortal(i, acknowledged[i] = next);
       ring_doorbell();
#endif
       /* ... to here */
       d_step { assert(payload[slot(next)] == next); assert(sequence[slot(next)] == 2 * next) }
#ifndef ACKNOWLEDGED_FIRST
       mortal(i, acknowledged[i] = next);
       ring_doorbell();
#endif
       next++;
       if :: next > FRAMES && !NO_FINAL -> goto leave :: else fi /* it was the final frame */
    od;

    /* say_goodbye */
  leave:
    outcome = ok;
#ifdef UNLOCKED_BEFORE_GOODBYE
    locked[i] = 0;
#endif
    mortal(i, consumer_state[i] = left);
    goto told;
  abort:
    mortal(i, d_step { waiting[i] = 0; asleep[i] = 0 });
    mortal(i, consumer_state[i] = gave_up);
  told:
    ring_doorbell();
#ifdef ENTRIES_REST
    left_at[i] = published;
#endif
    mortal(i, locked[i] = 0);
#ifndef NO_RING_AFTER_UNLOCK
    ring_doorbell();
#endif
    forget_consumer();
    if
    :: outcome == ok && joins < JOINS -> outcome = none; goto attach
    :: else
    fi;

  gone:
    atomic {
      assert(outcome != peer_dead || killed[PRODUCER]);
      locked[i] = 0;
      ended[i] = 1
    }

  dead:
    atomic { next = 0; there = 0; looked = 0; state = 0; outlook = 0; joins = 0; outcome = none }
}
