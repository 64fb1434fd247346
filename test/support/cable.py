# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""A cable between the host and a robot that it is linked with by keys: TCP, and UDP beside it."""
import socket
import threading


class Cable:
    """Passes on what the host says to the robot and back; keeps a copy, and may hold it up.

    :param endpoint: that of the robot
    """

    def __init__(self, endpoint):
        self._to = int(endpoint.rpartition(':')[2])
        self._server, self._near = self._listen()
        self._far = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._far.bind(('127.0.0.1', 0))
        self.endpoint = 'tls/127.0.0.1:{}'.format(self._server.getsockname()[1])
        # What the host said: the bytes of each connection, and datagrams.
        self.said, self.datagrams = [], []
        self._host = None
        self.flows = threading.Event()
        self.flows.set()
        for call in (self._accept, self._pass_down, self._pass_up):
            threading.Thread(target=call, daemon=True).start()

    @staticmethod
    def _listen():
        """Return sockets for TCP and for UDP on ports of one number."""
        while True:
            server = socket.create_server(('127.0.0.1', 0))
            datagrams = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            try:
                datagrams.bind(server.getsockname())
                return server, datagrams
            except OSError:
                server.close()
                datagrams.close()

    def _pass_down(self):
        while True:
            packet, self._host = self._near.recvfrom(65536)
            self.datagrams.append(packet)
            self.flows.wait()
            self._far.sendto(packet, ('127.0.0.1', self._to))

    def _pass_up(self):
        while True:
            packet = self._far.recv(65536)
            self.flows.wait()
            if self._host is not None:
                self._near.sendto(packet, self._host)

    def _accept(self):
        while True:
            try:
                near, _ = self._server.accept()
                far = socket.create_connection(('127.0.0.1', self._to))
            except OSError:
                continue
            copy = []
            self.said.append(copy)
            for one, other, kept in ((near, far, copy), (far, near, [])):
                threading.Thread(target=self._pass, args=(one, other, kept), daemon=True).start()

    def _pass(self, one, other, copy):
        try:
            while True:
                data = one.recv(65536)
                copy.append(data)
                self.flows.wait()
                other.sendall(data)
                if not data:
                    return
        except OSError:
            pass
        finally:
            for end in (one, other):
                end.close()
