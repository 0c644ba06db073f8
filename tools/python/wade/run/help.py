"""What tools/wade run --help says."""

HELP = """\
Usage: tools/wade run [SCENE] [--out DIR] [--no-figure]
                      [--record FILE | --replay FILE | --producer COMMAND]
                      [any option of the programs]

Runs SCENE, a file or a short name such as s05 or river/s05 (tools/wade scenes lists them) [s05]:
starts fluid_server and crowd_client, waits for both, prints the outcome and draws DIR/figure.png.

  --out DIR           run folder [runs/<scene>-<time>/ in the project]; the server's log is
                      DIR/fluid_server.log, that of another producer DIR/producer.log
  --record FILE       shm_record writes the water into FILE, frame by frame
  --replay FILE       shm_replay plays FILE in place of fluid_server; with --any-scene also the
                      water of another scene, which the crowd else refuses
  --producer COMMAND  another producer in place of fluid_server, as in a shell, for example
                      './my_producer --session {session}'; {session}, {scene} and {consumers} stand
                      for what the run has; without {session}, --session NAME is added at the end
  --crowds FILE       many crowds in this water (docs/commands.md): a run folder DIR/<name>/ each,
                      DIR/crowds.csv sums up
  --session NAME      name under which the programs meet [a unique one]
  --from-state FILE   the water goes on from a state that --save-state FILE or a numerical failure
                      has written
  --mode latest       the crowd takes the newest frame and the water waits for nobody; fluid_server
                      gets --consumers 0 and --clock real_time, unless you give them. Not with
                      --consumers 1 and more, --clock fast, --replay
  --no-figure         do not draw figure.png; nor is it drawn with --no-trajectories, which leaves
                      no paths
  --check             only check the scene and the options of both programs
Other options go to the programs that have them; see --help of build/release/fluid_server,
crowd_client, shm_record and shm_replay. Started from a terminal, the crowd takes commands typed
there (pause, step, tau ...); SIGUSR1 and SIGUSR2 are passed on to it.

Exit code: 0 if all programs ended well and the picture is drawn, else that of the program that
failed first: 1 unexpected, 2 bad configuration or usage, 3 attach time-out, 4 peer dead,
5 peer aborted, 6 protocol violation, 7 step time-out, 8 name in use, 9 numerical failure,
130/143 interrupted."""
