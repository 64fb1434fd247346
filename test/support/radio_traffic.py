# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""Traffic for a network that is to be measured: ``radio_traffic.py answer | udp | tcp``.

``answer`` sends back every datagram, and of every TCP stream its digest; the others talk to it.
"""
import argparse
import hashlib
import json
import random
import selectors
import socket
import sys
import threading
import time

PORT = 7007
# Room for every datagram of a test.
ROOM = 2 ** 23
SO_RCVBUFFORCE = 33
# No answer for so long: nothing is on its way any more, by 0.2 s at most in any test [s].
SILENCE_S = 1.5


def udp_socket():
    """Return a UDP socket that has room."""
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    made.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, ROOM)
    return made


def digest_of(stream):
    """Return the digest of a TCP stream, read to its end."""
    digest = hashlib.sha256()
    while True:
        data = stream.recv(65536)
        if not data:
            return digest.hexdigest()
        digest.update(data)


def answer(host):
    """Answer until killed."""
    udp = udp_socket()
    udp.bind((host, PORT))
    tcp = socket.create_server((host, PORT))
    selector = selectors.DefaultSelector()
    for one in (udp, tcp):
        selector.register(one, selectors.EVENT_READ)

    def serve(stream):
        with stream:
            stream.sendall(digest_of(stream).encode())
    print('ready', flush=True)
    while True:
        for key, _ in selector.select():
            if key.fileobj is udp:
                data, sender = udp.recvfrom(65536)
                udp.sendto(data, sender)
            else:
                threading.Thread(target=serve, args=(tcp.accept()[0],), daemon=True).start()


def udp(host, count, pace_s):
    """Send numbered datagrams; return how long each took there and back [s], of those that did."""
    link = udp_socket()
    link.connect((host, PORT))
    sent_s, took_s = {}, []

    def hear(patience_s):
        link.settimeout(max(1e-4, patience_s))
        try:
            number = int(link.recv(100).decode())
        except socket.timeout:
            return False
        took_s.append(time.monotonic() - sent_s[number])
        return True
    for number in range(count):
        sent_s[number] = time.monotonic()
        link.send(str(number).encode())
        while time.monotonic() < sent_s[number] + pace_s:
            hear(sent_s[number] + pace_s - time.monotonic())
    while len(took_s) < count and hear(SILENCE_S):
        pass
    return took_s


def tcp(host, count):
    """Send a number of bytes; return (seconds until the answer, whether all of it came)."""
    data = random.Random(1).getrandbits(8 * count).to_bytes(count, 'big')
    begun_s = time.monotonic()
    with socket.create_connection((host, PORT)) as link:
        link.sendall(data)
        link.shutdown(socket.SHUT_WR)
        said = link.recv(64, socket.MSG_WAITALL).decode()
    return time.monotonic() - begun_s, said == hashlib.sha256(data).hexdigest()


def main():
    """Run one of them; what was measured goes to the output as JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('what', choices=('answer', 'udp', 'tcp'))
    parser.add_argument('host')
    parser.add_argument('--count', type=int, default=100, help='datagrams, or bytes')
    parser.add_argument('--pace', type=float, default=0.002, help='between datagrams [s]')
    options = parser.parse_args()
    if options.what == 'answer':
        answer(options.host)
    json.dump(udp(options.host, options.count, options.pace) if options.what == 'udp'
              else tcp(options.host, options.count), sys.stdout)


if __name__ == '__main__':
    main()
