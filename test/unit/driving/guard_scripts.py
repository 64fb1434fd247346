# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is played to the guard on the robot, and what it has to answer; see play_guard.py."""

# What stands right of "=" is the answer.
SCRIPTS = {
    'a command that answers an echo is obeyed': '''
        0.00 echo a = -:0:*
        0.02 A:1:a 0.3 0.1 = 0.3 0.1
        0.02 echo b = A:1:*
        0.07 A:2:a 0.2 0 = 0.2 0
        0.12 A:9:b 0.1 0 = 0.1 0''',
    'a command that answers no echo is dropped': '''
        0.00 echo a = -:0:*
        0.02 A:1: 0.3 0 = none late
        0.02 A:1:never 0.3 0 = none late
        0.02 A:1: 0 0 = none late
        0.02 A:1:a 0.3 0 = 0.3 0''',
    'the age of a command is that of its token': '''
        0.00 echo a = -:0:*
        0.10 echo b = -:0:*
        0.99 A:1:a 0.3 0 = 0.3 0
        1.00 A:2:a 0.2 0 = none late
        1.09 A:3:b 0.1 0 = 0.1 0
        9.00 A:4:b 0.1 0 = none late''',
    'how old it may be can be said': '''
        with {"answer_s": 0.5}
        0.00 echo a = -:0:*
        0.49 A:1:a 0.3 0 = 0.3 0
        0.50 A:2:a 0.2 0 = none late''',
    'the lease ends in one zero and silence': '''
        0.00 echo a = -:0:*
        0.01 A:1:a 0.3 0.1 = 0.3 0.1
        0.30 tick = none
        0.31 tick = 0 0
        0.32 tick = none
        0.40 A:2:a 0.3 0.1 = 0.3 0.1
        0.69 tick = none
        0.70 tick = 0 0''',
    'a dropped command does not lengthen the lease': '''
        with {"lease_s": 0.5}
        0.00 echo a = -:0:*
        0.90 A:1:a 0.3 0 = 0.3 0
        1.39 A:2:a 0.3 0 = none late
        1.40 tick = 0 0''',
    'a repeated command is dropped, the lease is not lengthened': '''
        0.00 echo a = -:0:*
        0.01 A:5:a 0.3 0 = 0.3 0
        0.20 A:5:a 0.3 0 = none repeated
        0.21 A:4:a 0.3 0 = none repeated
        0.31 tick = 0 0
        0.32 A:5:a 0.3 0 = none repeated
        0.33 A:6:a 0.3 0 = 0.3 0''',
    'a recording played again moves nothing': '''
        0.00 echo a = -:0:*
        0.01 A:1:a 0.3 0 = 0.3 0
        0.06 A:2:a 0.3 0 = 0.3 0
        0.36 tick = 0 0
        0.40 A:1:a 0.3 0 = none repeated
        0.45 A:2:a 0.3 0 = none repeated
        60.0 A:1:a 0.3 0 = none repeated
        60.1 A:3:a 0.3 0 = none late
        60.2 B:3:a 0.3 0 = none late''',
    'a new session needs a young token, and the old one does not come back': '''
        0.00 echo a = -:0:*
        0.01 A:7:a 0.3 0 = 0.3 0
        0.90 echo b = A:7:*
        1.10 B:1:a 0.1 0 = none late
        1.10 A:8:b 0.2 0 = 0.2 0
        1.11 B:2:b 0.1 0 = 0.1 0
        1.12 A:9:b 0.2 0 = none replaced
        1.13 echo c = B:2:*
        1.14 A:10:c 0 0 = none replaced
        1.15 B:3:c 0.1 0 = 0.1 0''',
    'what is no frame_id is dropped': '''
        0.00 echo a = -:0:*
        0.01 map 0.3 0 = none unreadable
        0.01 A:-1:a 0.3 0 = none unreadable
        0.01 A:1:a:a 0.3 0 = none unreadable
        0.01 Ä:1:a 0.3 0 = none unreadable
        0.01 A:1e3:a 0.3 0 = none unreadable
        0.01 :1:a 0.3 0 = none unreadable''',
    'a stop is obeyed however late, by whomever, and holds': '''
        0.00 echo a = -:0:*
        0.01 A:5:a 0.3 0 = 0.3 0
        5.00 A!:6:a 0.3 0 = 0 0
        5.00 echo b = A:6:*!
        5.01 A:7:b 0.3 0 = none stopped
        5.10 echo c = A:6:*!
        5.11 A:8:c 0 0 = 0 0
        5.12 echo d = A:8:*
        5.13 A:9:d 0.3 0 = 0.3 0
        5.14 Z!:1: 0 0 = 0 0
        5.15 echo e = A:9:*!
        5.16 A:10:d 0 0 = none late
        5.17 A:11:e 0 0 = 0 0
        5.18 echo f = A:11:*''',
    'a stop needs no echo': '''
        0.00 A!:1: 0 0 = 0 0
        0.01 echo a = A:1:*!
        0.02 A:2:a 0.3 0 = none stopped
        0.03 A:3:a 0 0 = 0 0
        0.04 echo b = A:3:*''',
    'stops that stood in the network are answered once': '''
        0.00 echo a = -:0:*
        5.00 A!:1:a 0 0 = 0 0
        5.00 A!:2:a 0 0 = none
        5.00 echo b = A:2:*!
        5.01 A!:3:b 0 0 = 0 0
        5.02 Z!:1: 0 0 = none
        5.03 A:4:b 0 0 = 0 0''',
    'what the robot says itself is passed on, and holds for a second': '''
        0.00 own 0.3 0.1 = 0.3 0.1
        0.90 own 0.2 0 = 0.2 0
        1.89 tick = none
        1.90 tick = 0 0
        2.00 own 0 0 = 0 0
        9.00 tick = none''',
    'a command comes before what the robot says itself, for as long as it holds': '''
        0.00 echo a = -:0:*
        0.01 own 0.3 0 = 0.3 0
        0.02 A:1:a 0.1 0 = 0.1 0
        0.03 own 0.3 0 = none
        0.31 own 0.3 0 = none
        0.32 tick = 0 0
        0.33 own 0.3 0 = 0.3 0
        0.34 A:2:a 0 0 = 0 0
        0.63 own 0.3 0 = none
        0.64 own 0.3 0 = 0.3 0
        0.65 A:3:a 0.1 0 = 0.1 0
        0.95 tick = 0 0''',
    'nothing that the robot says itself passes a stop': '''
        0.00 echo a = -:0:*
        0.01 own 0.3 0 = 0.3 0
        0.02 A!:1: 0 0 = 0 0
        0.03 own 0.3 0 = none
        60.0 own 0.3 0 = none
        60.1 echo b = A:1:*!
        60.2 A:2:b 0 0 = 0 0
        60.3 own 0.3 0 = none
        60.5 own 0.3 0 = 0.3 0
        60.6 close = 0 0
        60.7 own 0.3 0 = none''',
    'what the robot says itself is slowed down, and braked': '''
        with {"speeds": [0.22, 1.0], "brake": true}
        0.00 move 0 0 0
        0.00 see 5.0
        0.01 own 0.44 1 = 0.22 0.5
        0.02 own nan 0 = 0 0
        0.03 own inf 0 = 0 0
        0.04 see 0.25
        0.05 own 0.2 0 = 0 0''',
    'what went back alone takes nothing from the robot itself': '''
        with {"back": [1.0, 5.0, 0.1]}
        0.00 echo a = -:0:*
        0.00 move 0 0 0
        0.01 A:1:a 0.3 0 = 0.3 0
        0.20 move 0.5 0 0
        0.31 tick = 0 0
        1.00 move 1.0 0 0
        1.00 see 5.0
        1.10 tick = 0 0.4
        1.11 own 0.3 0 = none
        1.12 answer = 0 0
        1.13 own 0.3 0 = none
        1.14 echo b = A:1:*
        1.15 A:2:b 0 0 = 0 0
        1.50 own 0.3 0 = 0.3 0''',
    'a stop survives the loss of the link': '''
        0.00 echo a = -:0:*
        0.01 A!:1:a 0 0 = 0 0
        0.05 echo b = A:1:*!
        0.40 tick = none
        3600 tick = none
        3600 A:2:b 0 0 = none late
        3600 echo c = A:1:*!
        3601 A:3:c 0.3 0 = none late
        3601 echo d = A:1:*!
        3601 A:4:d 0.3 0 = none stopped
        3601 A:5:d 0 0 = 0 0
        3601 A:6:d 0.3 0 = 0.3 0''',
    'what was under way before the stop cannot release it': '''
        0.00 echo a = -:0:*
        0.01 A!:1:a 0 0 = 0 0
        0.01 A:2:a 0 0 = none late
        0.02 B:1:a 0 0 = none late
        0.03 echo b = A:1:*!
        0.04 A!:3:b 0 0 = 0 0
        0.05 A:4:b 0 0 = 0 0''',
    'a stop with a lower number stops until the next that answers': '''
        0.00 echo a = -:0:*
        0.01 A:9:a 0.3 0 = 0.3 0
        0.02 A!:4:a 0 0 = 0 0
        0.03 echo b = A:9:*!
        0.04 A:5:b 0 0 = none repeated
        0.05 A:10:b 0 0 = 0 0
        0.06 A:11:b 0.3 0 = 0.3 0''',
    'a session that was replaced can stop, and nothing else': '''
        0.00 echo a = -:0:*
        0.01 A:1:a 0.3 0 = 0.3 0
        0.02 B:1:a 0.2 0 = 0.2 0
        0.03 A!:2:a 0 0 = 0 0
        0.04 echo b = B:1:*!
        0.05 A:3:b 0 0 = none replaced
        0.06 B:2:b 0 0 = 0 0''',
    'a velocity that cannot be is a zero, and releases nothing': '''
        0.00 echo a = -:0:*
        0.01 A:1:a 0.3 0 = 0.3 0
        0.02 A:2:a nan 0 = 0 0 no_velocity
        0.03 A:3:a 0.1 inf = 0 0 no_velocity
        0.04 A:4:a -1e9 0 = 0 0 no_velocity
        0.05 A!:5:a nan nan = 0 0
        0.06 echo b = A:5:*!
        0.07 A:6:b nan 0 = none stopped
        0.08 A:7:b 0 nan = none stopped
        0.09 echo c = A:5:*!''',
    'a limit on speed keeps the curvature': '''
        with {"speeds": [0.5, 1.0]}
        0.00 echo a = -:0:*
        0.01 A:1:a 0.4 -0.9 = 0.4 -0.9
        0.02 A:2:a 1.0 1.0 = 0.5 0.5
        0.03 A:3:a -0.5 4.0 = -0.125 1
        0.04 A:4:a -2.0 8.0 = -0.25 1''',
    'a limit on one of the two': '''
        with {"speeds": [0.0, 1.0]}
        0.00 echo a = -:0:*
        0.01 A:1:a 4.0 0.5 = 4 0.5
        0.02 A:2:a 4.0 2.0 = 2 1''',
    'what goes sideways is passed on, with one factor for all three': '''
        with {"speeds": [0.5, 1.0]}
        0.00 echo a = -:0:*
        0.01 A:1:a 0 0 -0.4 = 0 0 -0.4
        0.02 A:2:a 0.6 0.2 -0.8 = 0.3 0.1 -0.4
        0.03 A:3:a 0 2 0.5 = 0 1 0.25
        0.04 A:4:a 0 0 nan = 0 0 no_velocity
        0.05 own 0 0 0.3 = none
        0.35 own 0 0 0.3 = 0 0 0.3''',
    'it is not a zero': '''
        0.00 echo a = -:0:*
        0.01 A!:1:a 0 0 = 0 0
        0.02 echo b = A:1:*!
        0.03 A:2:b 0 0 0.1 = none stopped
        0.04 A:3:b 0 0 = 0 0
        0.05 A:4:b 0 0 0.1 = 0 0 0.1
        0.35 tick = 0 0''',
    'sideways speed grows as well': '''
        with {"gains": [1.6, 0.0], "lease_s": 0.25}
        8.00000 echo a = -:0:*
        8.00000 A:1:a 0 0 0.2 = 0 0 0.08
        8.03125 A:2:a 0.3 0 0.4 = 0.0684 0 0.0912
        8.06250 A:3:a 0 0 -0.2 = 0 0 -0.05
        8.09375 A:4:a 0 0 -0.01 = 0 0 -0.01''',
    'the brake looks to where it goes': '''
        with {"brake": true}
        0.00 echo a = -:0:*
        0.00 move 0 0 0
        0.00 see 0.3
        0.01 A:1:a 0 0 0.2 = 0 0 0.2
        0.02 A:2:a 0.2 0 0.0 = 0.069167 0
        0.40 A:3:a 0 0 0.2 = 0 0
        0.41 A:4:a -0.3 0 0.1 = 0 0
        0.42 A:5:a -0.3 0 = -0.1 0''',
    'speed grows as the limit on acceleration has it, and goes at once': '''
        with {"gains": [1.6, 0.0], "lease_s": 0.25}
        8.00000 echo a = -:0:*
        8.00000 A:1:a 0.2 2.0 = 0.08 2
        8.01000 tick = none
        8.03125 tick = 0.13 2
        8.06250 tick = 0.18 2
        8.09375 tick = 0.2 2
        8.12500 tick = none
        8.12500 A:2:a 0.02 2.0 = 0.02 2
        8.15625 A:3:a -1.0 2.0 = -0.05 2
        8.18750 A:4:a 0 0 = 0 0
        8.21875 tick = none
        8.21875 A:5:a -1.0 0 = -0.05 0
        8.25000 A!:6:a 0 0 = 0 0
        8.28125 tick = none''',
    'it speeds up in steps of 20 ms': '''
        with {"gains": [1.6, 0.0]}
        8.0000000 echo a = -:0:*
        8.0000000 A:1:a 0.2 0 = 0.08 0
        8.0156250 tick = none
        8.0234375 tick = 0.1175 0''',
    'a lease ends on the way to a velocity, too': '''
        with {"gains": [0.1, 0.1], "lease_s": 0.1}
        9.00 echo a = -:0:*
        9.00 A:1:a 1.0 0.0 = 0.005 0
        9.05 tick = 0.01 0
        9.10 tick = 0 0
        9.12 tick = none''',
    'the end is a zero for a robot that is driven, and the last word': '''
        0.00 echo a = -:0:*
        0.01 A:1:a 0.3 0 = 0.3 0
        0.02 close = 0 0
        0.03 A:2:a 0.3 0 = none ending
        0.04 A!:3:a 0 0 = none ending
        0.05 close = none''',
    'a robot that stands is told nothing at the end': '''
        0.00 close = none''',
    'without a scan there is no way forward, and a crawl back': '''
        with {"brake": true}
        0.00 echo a = -:0:*
        0.01 A:1:a 0.3 0.2 = 0 0.2
        0.02 A:2:a -0.3 0.2 = -0.1 0.2
        0.03 see 5.0
        0.04 A:3:a 0.3 0 = 0 0
        0.05 move 0 0 0
        0.06 see 5.0
        0.07 A:4:a 0.3 0 = 0.3 0
        0.30 A:5:a 0.3 0 = 0.3 0
        0.36 tick = none
        0.37 tick = 0 0
        0.42 tick = none
        0.43 A:6:a 0 0.4 = 0 0.4''',
    'odometry that is old makes a scan worth nothing': '''
        with {"brake": true}
        0.00 echo a = -:0:*
        0.00 move 0 0 0
        0.51 see 5.0
        0.52 A:1:a 0.3 0 = 0 0''',
    'a scan brakes what is held, and what is free again goes on': '''
        with {"brake": true}
        0.00 echo a = -:0:*
        0.00 move 0 0 0
        0.00 see 5.0
        0.01 A:1:a 0.3 0.1 = 0.3 0.1
        0.05 see 0.25
        0.05 tick = none
        0.07 tick = 0 0.1
        0.12 tick = none
        0.13 A:2:a -0.3 0.1 = -0.3 0.1
        0.14 see 5.0
        0.15 A:3:a 0.3 0.1 = 0.3 0.1
        0.46 tick = 0 0''',
    'a scan brakes what is held within a twentieth of a second': '''
        with {"brake": true}
        0.00 echo a = -:0:*
        0.00 move 0 0 0
        0.00 see 5.0
        0.00 A:1:a 0.3 0 = 0.3 0
        0.04 see 0.25
        0.04 tick = none
        0.05 tick = 0 0''',
    'it stands before a wall however slowly it came': '''
        with {"brake": true}
        0.00 echo a = -:0:*
        0.00 move 0 0 0
        0.00 see 5.0
        0.01 A:1:a 0.008 0 = 0.008 0
        0.05 see 0.25
        0.07 tick = 0 0''',
    'what is too near to be seen is remembered': '''
        with {"brake": true}
        0.00 echo a = -:0:*
        0.00 move 0 0 0
        0.00 see 0.3
        0.10 move 0.2 0 0
        0.10 see inf
        0.11 A:1:a 0.3 0 = 0 0
        0.12 A:2:a -0.3 0 = -0.3 0
        0.20 move 0 0 0
        0.20 see inf
        0.21 A:3:a 0.3 0 = 0.3 0''',
    'a robot that is not heard any more goes back along its trail': '''
        with {"back": [10, 5.0, 0.1]}
        0.00 echo a = -:0:*
        0.00 move 0 0 0
        0.01 heard a = none
        0.02 move 0.2 0 0
        0.03 move 0.4 0 0
        10.00 move 0.4 0 0
        10.00 see inf
        10.00 tick = none
        10.01 tick = 0 0.4
        10.02 tick = none
        10.10 move 0.4 0 180
        10.10 see inf
        10.11 tick = 0.1 0
        10.20 move 0.2 0 180
        10.20 tick = 0.1 0
        10.25 move 0.02 0 180
        10.26 tick = 0 0
        10.30 tick = none
        60.00 tick = none''',
    'it stops at once when it is heard, and wants a centred stick': '''
        with {"back": [10, 5.0, 0.1]}
        0.00 echo a = -:0:*
        0.00 move 0 0 0
        0.01 A:1:a 0.2 0 = 0.2 0
        0.02 move 0.5 0 180
        0.31 tick = 0 0
        10.00 move 0.5 0 180
        10.00 see inf
        10.00 tick = none
        10.02 tick = 0.1 0
        10.03 echo b = A:1:*
        10.04 heard a = none
        10.05 heard b = 0 0
        10.06 A:2:b 0.2 0 = none came_back
        10.07 A:3:b 0 0 = 0 0
        10.08 A:4:b 0.2 0 = 0.2 0''',
    'it stops at once when the sender answers on a new connection, and no answer is a word': '''
        with {"back": [10, 5.0, 0.1]}
        0.00 echo a = -:0:*
        0.00 move 0 0 0
        0.00 answer = none
        0.01 A:1:a 0.2 0 = 0.2 0
        0.02 move 0.5 0 180
        0.10 answer = none
        0.31 tick = 0 0
        10.02 move 0.5 0 180
        10.02 see inf
        10.02 tick = 0.1 0
        10.03 answer = 0 0
        10.04 echo b = A:1:*
        10.06 A:2:b 0.2 0 = none came_back
        19.00 answer = none
        28.90 move 0.5 0 180
        28.90 see inf
        28.90 tick = none
        29.10 move 0.5 0 180
        29.10 see inf
        29.10 tick = 0.1 0
        29.20 heard = 0 0
        30.40 answer = none
        60.00 tick = none''',
    'a command is heard as well, and a stop holds it where it is': '''
        with {"back": [10, 5.0, 0.1]}
        0.00 echo a = -:0:*
        0.00 move 0 0 0
        0.01 heard a = none
        0.02 move 0.5 0 180
        10.00 move 0.5 0 180
        10.00 see inf
        10.02 tick = 0.1 0
        10.03 echo b = -:0:*
        10.04 A:1:b 0.2 0 = 0 0 came_back
        10.05 echo c = -:0:*
        20.20 move 0.5 0 180
        20.20 see inf
        20.21 tick = 0.1 0
        20.22 Z!:1: 0 0 = 0 0
        20.30 tick = none
        40.00 move 0.5 0 180
        40.00 see inf
        40.01 tick = none''',
    'never heard, or told that the sender ends: it stays': '''
        with {"back": [10, 5.0, 0.1]}
        0.00 echo a = -:0:*
        0.00 move 0 0 0
        0.02 move 0.5 0 180
        20.00 move 0.5 0 180
        20.00 see inf
        20.00 tick = none
        20.01 echo b = -:0:*
        20.02 heard b = none
        20.03 heard = none
        40.00 move 0.5 0 180
        40.00 see inf
        40.01 tick = none''',
    'what was said before the end and comes after it does not count': '''
        with {"back": [10, 5.0, 0.1]}
        0.00 echo a = -:0:*
        0.00 move 0 0 0
        0.00 heard a = none
        0.00 heard = none
        0.03 heard a = none
        0.04 A:1:a 0 0 = 0 0
        0.05 move 0.5 0 180
        20.00 move 0.5 0 180
        20.00 see inf
        20.01 tick = none
        20.02 echo b = A:1:*
        20.03 heard b = none
        40.00 move 0.5 0 180
        40.00 see inf
        40.01 tick = 0.1 0''',
    'no way back without a scan, nor through what is in it, nor further than was said': '''
        with {"back": [1, 0.3, 0.1]}
        0.00 echo a = -:0:*
        0.00 move 0 0 0
        0.01 heard a = none
        0.02 move 1.0 0 180
        1.02 tick = none
        1.03 move 1.0 0 180
        1.04 tick = none
        1.10 see 0.25
        1.11 tick = none
        1.20 see inf
        1.21 tick = 0.1 0
        1.30 move 0.8 0 180
        1.31 tick = 0.1 0
        1.52 tick = 0 0
        1.60 see inf
        1.61 tick = 0.1 0
        1.70 move 0.69 0 180
        1.71 tick = 0 0
        1.80 see inf
        1.81 tick = none''',
    'a guard that ends on the way back gives a zero': '''
        with {"back": [1, 5.0, 0.1]}
        0.00 echo a = -:0:*
        0.00 move 0 0 0
        0.01 heard a = none
        0.02 move 1.0 0 180
        1.03 move 1.0 0 180
        1.03 see inf
        1.04 tick = 0.1 0
        1.05 close = 0 0
        1.20 tick = none''',
}


def backlog(stall_s):
    """A link stalls while the stick is held; then all comes at once, and the link is as before."""
    lines = ['0.00 echo a = -:0:*']
    for number in range(1, int(20 * stall_s) + 1):
        late = ' = none late' if stall_s >= 1.0 else ' = 0.3 0'
        lines.append('{} A:{}:a 0.3 0{}'.format(stall_s, number, late))
    lines += ['{} echo b = {}'.format(stall_s, 'A:{}:*'.format(number) if stall_s < 1.0 else
                                      '-:0:*'),
              '{} A:{}:b 0.2 0 = 0.2 0'.format(stall_s + 0.05, number + 1)]
    return '\n'.join(lines)


SCRIPTS.update({'a backlog of {} s'.format(stall_s): backlog(stall_s)
                for stall_s in (0.95, 1.0, 15.0)})
