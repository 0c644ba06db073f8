/* publisher.cpp, publisher_state.cpp. Parts of lockstep.pml. */

#ifdef GOODBYE_BY_STATE /* producers up to version 1.1 */
#define parted(i) 1
#else
#define parted(i) (!locked[i])
#endif

/* Publisher::State::survey of one entry; admit_at 0 admits nobody. The entry's state is read in one step, what follows
   from it is done in the next, with the look at the lock: a goodbye counts once that is free. */
inline survey_entry(i, first, admit_at) {
  d_step {
    if :: first -> anyone = 0; leader = 0; enough = 1; news = 0 :: else fi;
    seen = consumer_state[i];
    if
    :: seen == joined && mine[i] == 0 && admit_at == 0 -> seen = none
    :: seen == gave_up && mine[i] == 0 && started -> seen = none
    :: seen == left && mine[i] == 0 -> seen = none
    :: seen == free_ -> seen = none
    :: else
    fi
  }
  if
  :: die_if(PRODUCER, seen == left && parted(i) || seen == joined && mine[i] == 0)
  :: atomic { seen == none }
  :: atomic { seen == gave_up -> outcome = peer_aborted; goto abort }
  :: d_step { seen == left && parted(i) -> mine[i] = 0; admitted[i] = 0 }
  :: d_step { seen == joined && mine[i] == 0 -> mine[i] = admit_at; admitted[i] = admit_at; news = 1;
              anyone = 1; leader = leader || leads(i); had_lockstep = had_lockstep || leads(i);
              enough = enough && admit_at - 1 >= owed }
  :: d_step { mine[i] != 0 && (seen == joined || seen == left && !parted(i)) -> anyone = 1; leader = leader || leads(i); had_lockstep = had_lockstep || leads(i);
              assert(acknowledged[i] <= published); enough = enough && max(acknowledged[i], mine[i] - 1) >= owed }
  fi
}

/* Publisher::State::survey: leaves anyone, leader (somebody who does not only follow), enough */
inline survey(admit_at) {
  survey_entry(0, 1, admit_at);
  survey_entry(1, 0, admit_at);
  if :: news -> ring() :: else fi
}

/* Publisher::State::check_alive of one entry: once while it lives (with EARLY_LOOKS), once after its death, in each wait */
inline check_alive(i) {
  d_step { looked[i] = 1 + killed[i]; due = mine[i] != 0 && consumer_state[i] == joined }
  due = due && !locked[i];
#ifndef NO_SECOND_LOOK
  due = due && consumer_state[i] == joined;
#endif
  due = due && acknowledged[i] < owed;
  atomic {
    if
    :: due -> due = 0; assert(killed[i]); outcome = peer_dead; goto abort
    :: else
    fi
  }
}

#ifdef EARLY_LOOKS
#define may_look(i) (looked[i] == 0 || (killed[i] && looked[i] < 2))
#else
#define may_look(i) (killed[i] && looked[i] < 2)
#endif

/* wait_for_peer; the spinning before it is a survey that may be repeated. A slice ends a sleep only when there is a
   death to be found; then all is looked at once more, for what the dead one did last. */
inline wait(is_ready, admit_at, may_time_out) {
  survey(admit_at);
  if
  :: is_ready
  :: else ->
#ifndef NO_PRODUCER_FLAG
     mortal(PRODUCER, waiting[PRODUCER] = 1);
#endif
     do
     :: fresh[PRODUCER] = 1;
        survey(admit_at);
        if :: is_ready -> break :: else fi;
        futex_sleep(PRODUCER);
        do
        :: !asleep[PRODUCER] -> break
        :: die(PRODUCER)
#ifndef NO_PRODUCER_LIVENESS
        :: asleep[PRODUCER] && may_look(0) ->
           check_alive(0);
           if :: looked[0] == 2 -> asleep[PRODUCER] = 0 :: else fi
        :: asleep[PRODUCER] && may_look(1) ->
           check_alive(1);
           if :: looked[1] == 2 -> asleep[PRODUCER] = 0 :: else fi
#endif
        :: asleep[PRODUCER] && may_time_out -> outcome = attach_timeout; goto abort
#ifdef ABORTS
        :: asleep[PRODUCER] -> outcome = interrupted; goto abort
#endif
        od
     od;
     mortal(PRODUCER, d_step { waiting[PRODUCER] = 0; looked[0] = 0; looked[1] = 0 })
  fi
}

/* What consumer i may rely on: published <= acknowledged + depth */
#define in_reach(i) (mine[i] == 0 || consumer_state[i] != joined || published <= max(acknowledged[i], mine[i] - 1) + DEPTH)
#define served(i) (mine[i] == 0 || consumer_state[i] != joined || max(acknowledged[i], mine[i] - 1) == published)

/* Equal states of the rest shall be equal states. */
inline forget_producer() {
  atomic {
  frame = 0; owed = 0; mine[0] = 0; mine[1] = 0; looked[0] = 0; looked[1] = 0; outcome = none; seen = none;
  anybody = 0; due = 0; anyone = 0; leader = 0; enough = 0; news = 0; started = 0; had_lockstep = 0; final = 0
  }
}

#ifdef ONE_FRAME_TOO_EARLY
#define AHEAD (DEPTH + 1)
#else
#define AHEAD DEPTH
#endif

proctype producer() {
  byte frame = 1, owed;
  byte mine[2];   /* private copy of admitted */
  byte looked[2]; /* 0 not in this sleep, 1 while it lived, 2 after its death */
  bit anybody, due, anyone, leader, enough, news, started, had_lockstep, final;
  mtype seen, outcome = none;
    /* Publisher::State::State: the magic is stored last, so attaching begins with the state `ready` */
    atomic { locked[PRODUCER] = 1; producer_state = ready }

    /* wait_for_consumers(1); nobody left who could come = time-out */
    wait(anyone, 1, ended[0] && ended[1]);

    /* begin_frame */
    mortal(PRODUCER, producer_state = running);
    started = 1;
    ring();
    do
    :: owed = (frame > AHEAD -> frame - AHEAD : 0);
       wait(enough || (!leader && had_lockstep), frame, 0);
       if
       :: !leader && had_lockstep -> break /* all have left: begin_frame is empty */
       :: else
       fi;
       final = (frame == FRAMES && !NO_FINAL);
#ifdef PUBLISHED_FIRST
       mortal(PRODUCER, published = frame);
       ring();
#endif
       mortal(PRODUCER, sequence[slot(frame)] = 2 * frame - 1);
       mortal(PRODUCER, payload[slot(frame)] = 0); /* being written */
#ifdef PUBLISHED_BEFORE_PAYLOAD
       mortal(PRODUCER, sequence[slot(frame)] = 2 * frame);
       mortal(PRODUCER, published = frame);
       mortal(PRODUCER, payload[slot(frame)] = frame);
#else
       mortal(PRODUCER, payload[slot(frame)] = frame);
       /* end_frame */
#ifdef PUBLISHED_BEFORE_SEQUENCE
       mortal(PRODUCER, published = frame);
       mortal(PRODUCER, sequence[slot(frame)] = 2 * frame);
#else
       mortal(PRODUCER, sequence[slot(frame)] = 2 * frame);
#ifdef FLAG_TESTED_FIRST
       anybody = waiting[0] || waiting[1];
#endif
       mortal(PRODUCER, d_step { published = frame; assert(in_reach(0)); assert(in_reach(1)) });
#endif
#endif
       frame++;
       if :: final -> mortal(PRODUCER, producer_state = draining) :: else fi;
#ifdef FLAG_TESTED_FIRST
       d_step { fresh[0] = 0; fresh[1] = 0 }
       d_step { if :: anybody -> wake_consumers() :: else fi; anybody = 0 }
#elif !defined(PUBLISHED_FIRST)
       ring();
#endif
       if
       :: final || frame > FRAMES -> break
       :: else
       fi
    od;

    /* close */
    mortal(PRODUCER, producer_state = draining);
#ifndef NO_RING_AT_THE_END
    ring();
#endif
    atomic { owed = frame - 1; frame = 0; final = 0 }
    wait(enough, 0, 0);
    outcome = ok;
    mortal(PRODUCER, producer_state = closed);
#ifndef NO_RING_AT_THE_END
    ring();
#endif
    goto gone;

  abort:
    mortal(PRODUCER, d_step { waiting[PRODUCER] = 0; asleep[PRODUCER] = 0 });
    mortal(PRODUCER, producer_state = aborted);
    ring();

  gone:
    atomic {
      assert(outcome != ok || (served(0) && served(1)));
      locked[PRODUCER] = 0;
      ended[PRODUCER] = 1
    }

  dead:
    forget_producer()
}
