# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Messages of ``kobuki_msgs`` as Kobuki defines them (http://docs.ros.org/api/kobuki_msgs)."""
from genpy.dynamic import generate_dynamic

_HEADER = '\n'.join(('', '=' * 80, 'MSG: std_msgs/Header', 'uint32 seq', 'time stamp',
                     'string frame_id', ''))


def _made(name, text):
    return generate_dynamic('kobuki_msgs/' + name, text)['kobuki_msgs/' + name]


MotorPower = _made('MotorPower', 'uint8 OFF = 0\nuint8 ON  = 1\nuint8 state\n')
Led = _made('Led', 'uint8 BLACK   = 0\nuint8 GREEN   = 1\nuint8 ORANGE  = 2\nuint8 RED     = 3\n'
            'uint8 value\n')
Sound = _made('Sound', 'uint8 ON            = 0\nuint8 OFF           = 1\n'
              'uint8 RECHARGE      = 2\nuint8 BUTTON        = 3\nuint8 ERROR         = 4\n'
              'uint8 CLEANINGSTART = 5\nuint8 CLEANINGEND   = 6\nuint8 value\n')
# Without its constants.
SensorState = _made('SensorState', '\n'.join((
    'Header header', 'uint16 time_stamp', 'uint8 bumper', 'uint8 wheel_drop', 'uint8 cliff',
    'uint16 left_encoder', 'uint16 right_encoder', 'int8 left_pwm', 'int8 right_pwm',
    'uint8 buttons', 'uint8 charger', 'uint8 battery', 'uint16[] bottom', 'uint8[] current',
    'uint8 over_current', 'uint16 digital_input', 'uint16[] analog_input')) + _HEADER)
