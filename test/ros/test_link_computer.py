# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""What tells two computers of one name apart on a link without keys."""
import os

from mhri.link.ros.computer import facts


def computer(folder, identity, cards):
    """Lay out the files of a computer; return what is called of it."""
    folder.mkdir()
    (folder / 'machine-id').write_text(identity + '\n')
    for name, (address, kind) in cards.items():
        place = folder / 'net' / name
        place.mkdir(parents=True)
        (place / 'address').write_text(address + '\n')
        for file in kind.split():
            (place / file).touch()
    return facts(str(folder / 'net'), str(folder / 'machine-id'), 'http://lab:11311')


def test_copies_of_one_disk_differ_by_their_cards(tmp_path):
    rows = {name: computer(tmp_path / name, 'same', {
        'lo': ('00:00:00:00:00:00', ''), 'eth0': (address, 'device'),
        'wlan0': (radio, 'device phy80211'), 'docker0': (radio, '')})
        for name, address, radio in (('a', '02:01', '02:aa'), ('b', '02:02', '02:aa'),
                                     ('later', '02:01', '02:bb'))}
    assert rows['a'] != rows['b']
    assert rows['a'] == rows['later'] == ['same', 'http://lab:11311', '02:01']


def test_of_a_computer_without_a_wire_the_others_count(tmp_path):
    radio = {'wlan0': ('02:aa', 'device phy80211')}
    assert computer(tmp_path / 'radio', 'm', radio)[2:] == ['02:aa']
    assert computer(tmp_path / 'box', 'm', {'eth0': ('02:bb', '')})[2:] == ['02:bb']


def test_what_cannot_be_read_is_left_out(tmp_path):
    nothing = str(tmp_path / 'nothing')
    assert facts(nothing, nothing, 'http://lab:11311') == ['', 'http://lab:11311']


def test_two_masters_on_this_computer_are_two_hosts():
    assert facts(uri='http://lab:1') != facts(uri='http://lab:2')
    assert facts() == facts(uri=os.environ['ROS_MASTER_URI'])
