# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""All uses of rospy's internals, in one place, checked at import.

rospy is no longer developed (ros_comm was archived in 2025), but a distribution may patch it: this
module checks at import for all internals it uses, and raises an :class:`ImportError` that names the
missing ones. The transport of messages on the driving path is in
:mod:`mhri.graph.ros.non_blocking`.

:func:`caller_of`, :func:`listeners`, :func:`on_publisher_gone`, :func:`publisher_processes` and
:func:`publisher_uri` identify the node at the other end of a connection, and report its loss.
"""
import os
import sys

import rospy
from rospy.impl.masterslave import ROSHandler
from rospy.impl.paramserver import get_param_server_cache
from rospy.impl.registration import (
    get_registration_listeners, get_service_manager, get_topic_manager)
from rospy.impl.tcpros_base import TCPROSTransport


def caller_of(message):
    """Return the caller id of the sender of a message, '' if unknown."""
    return (message._connection_header or {}).get('callerid', '')


def type_of(message):
    """Return the ROS type of a message as declared by its publisher."""
    return message._connection_header['type']


def field_type(message, field):
    """Return the ROS type of a field of a message, such as ``float64[]``."""
    return message._slot_types[message.__slots__.index(field)]


def md5sum_of(message):
    """Return the MD5 sum of a message's definition as declared by its publisher, '' if unknown."""
    return message._connection_header.get('md5sum', '')


def link_of(message):
    """Return an object that is the same for all messages of one connection, None if unknown."""
    return getattr(message, '_connection_header', None)


def keep_link(message, source):
    """Give a message the connection of another one from whose bytes it was made."""
    message._connection_header = link_of(source)


def listeners(connections):
    """Return the caller ids at the other end of a publisher's connections."""
    return {connection.endpoint_id for connection in connections}


def peer_hosts(connections):
    """Return {caller id: network address} of the nodes at the other end of connections."""
    found = {}
    for connection in connections:
        try:
            host = connection.socket.getpeername()[0]
        except (OSError, AttributeError, IndexError):
            continue  # it has just ended
        caller = connection.callerid_pub
        found[connection.endpoint_id if caller == 'unknown' else caller] = host
    return found


def _links(subscriber):
    """Return the open connections of a ``rospy.Subscriber``."""
    impl = subscriber.impl
    return impl.connections if impl else ()


def publisher_hosts(subscriber):
    """Return {caller id: network address} of the publishers connected to a ``rospy.Subscriber``."""
    return peer_hosts(_links(subscriber))


def publishers(subscriber):
    """Return the caller ids of the publishers connected to a ``rospy.Subscriber``."""
    return {link.callerid_pub for link in _links(subscriber)}


def publisher_uri(subscriber):
    """Return the XML-RPC address of a node that publishes the subscribed topic, or None."""
    return next((uri for _, uri in publisher_processes(subscriber) if uri), None)


def publisher_processes(subscriber):
    """Return (caller id, XML-RPC address) of each connected publisher, as a list."""
    return [(link.callerid_pub, link.endpoint_id) for link in _links(subscriber)]


def sender_uri(subscriber, message):
    """Return the XML-RPC address of the sender of a subscriber's message, '' if unknown."""
    return next((link.endpoint_id for link in _links(subscriber)
                 if link.header is link_of(message)), None) or ''


def latches(message):
    """Return whether the publisher of a message latches its last one."""
    return str((message._connection_header or {}).get('latching', '0')) == '1'


def on_publisher_gone(subscriber, call):
    """Call a function whenever the connection to a publisher ends.

    rospy reports that only for subscribers. A killed publisher on this computer shows within
    milliseconds: the kernel closes its connections.

    :param call: called with the publisher's caller id and the XML-RPC address of its process on the
        connection's thread; must be quick
    """
    impl = subscriber.impl
    plain = impl.remove_connection

    def remove_connection(connection):
        """Let rospy remove the connection, then call the function."""
        plain(connection)
        who = connection.callerid_pub, connection.endpoint_id
        if who not in publisher_processes(subscriber):
            call(*who)

    impl.remove_connection = remove_connection


_OTHERS_ONLY = set()
_has_connection = rospy.topics._SubscriberImpl.has_connection


def _connected(impl, endpoint_id):
    """Return whether a subscription has a connection to a publisher, or must not have one."""
    return (impl.resolved_name in _OTHERS_ONLY and endpoint_id == rospy.get_node_uri()
            or _has_connection(impl, endpoint_id))


rospy.topics._SubscriberImpl.has_connection = _connected


def others_only(topic):
    """Keep subscribers of a topic from connecting to this node, which publishes it, too.

    Every message would come back, and be read on another thread. Call it before subscribing.

    :param topic: its absolute name
    """
    _OTHERS_ONLY.add(rospy.names.resolve_name(topic))


def name_in(namespace='/'):
    """Put this program's node, with its parameters, in a namespace, whatever its caller says.

    There is one of each of mhri's nodes on a master, under a fixed name. ``ROS_NAMESPACE``, set in
    a terminal for some robot, would give it another one, and its parameters with it. Call it before
    ``init_node``.

    :returns: the namespace it would have had
    """
    given = rospy.get_namespace()
    os.environ.pop('ROS_NAMESPACE', None)
    sys.argv[:] = [word for word in sys.argv if not word.startswith('__ns:=')]
    rospy.names._set_caller_id(namespace.rstrip('/') + '/unnamed')
    return given


def is_initialised():
    """Return whether ``rospy.init_node`` was called in this process."""
    return rospy.core.is_initialized()


def ended_by_hand():
    """Return a function that returns whether this node was ended by ``rosnode kill``.

    The master, which ends the older of two nodes with one name, does not count. Call it after
    ``init_node``.
    """
    reasons = []
    rospy.core.add_preshutdown_hook(reasons.append)
    return lambda: any('user request' in reason for reason in reasons)


def unsubscribe(subscriber):
    """Unregister a ``rospy.Subscriber`` (blocking: calls the master).

    rospy leaves the epoll handle of the topic open until the garbage collector collects its oldest
    generation (ros_comm issue 2373), hundreds of them as an operator toggles views: this closes it.
    """
    impl = subscriber.impl
    subscriber.unregister()
    if impl is not None and impl.closed:
        impl.connection_poll.poller.close()


def never_ask_for(name, value):
    """Set rospy's cached value of a parameter, so that it never reads it from the master."""
    get_param_server_cache().set(name, value)


def skip_number(publisher):
    """Skip a sequence number of a ``rospy.Publisher``, as if a message was lost in transit."""
    publisher.impl.seq += 1


def answer_late(wait):
    """Call a function before this process answers a request for its id, as by the link probe."""
    plain = ROSHandler.getPid

    def get_pid(handler, caller_id):
        wait()
        return plain(handler, caller_id)

    ROSHandler.getPid = get_pid


def end_by_own_name():
    """Accept a shutdown by the master only if it names this node.

    The master sends a shutdown to the old address of a crashed node when another one takes its
    name: the process that has that port by then would end. Every rospy node that has logged
    anything stays registered this way, by its subscription to a parameter.
    """
    plain = ROSHandler.shutdown

    def shutdown(handler, caller_id, msg=''):
        if caller_id == '/master' and msg.startswith('[/') and not msg.startswith(
                '[{}]'.format(rospy.get_name())):
            return 1, 'another node had this address', 0
        return plain(handler, caller_id, msg)

    ROSHandler.shutdown = shutdown


def is_ending():
    """Return whether this node is ending: it unregisters before ``is_shutdown`` is true."""
    return rospy.core.is_shutdown_requested()


def registrations():
    """Return this node's registrations: ([(topic, type)], [(service, URI)], [(topic, type)]).

    These are publications, services and subscriptions.
    """
    topics = get_topic_manager()
    return (topics.get_publications(), get_service_manager().get_services(),
            topics.get_subscriptions())


def connect_publishers(topic, uris):
    """Connect this node's subscription to publishers, as if the master had reported them."""
    manager = next(iter(get_registration_listeners().listeners), None)
    if manager is not None:
        manager.publisher_update(topic, uris)


def require(methods, names):
    """Check for the internals that a module uses.

    :param methods: [(class or module, names of its functions)]
    :param names: [(function, names that it uses)]
    :raises ImportError: rospy differs from the version this was written for
    """
    missing = ['{}.{}'.format(owner.__name__, name) for owner, wanted in methods for name in wanted
               if not callable(getattr(owner, name, None))]
    missing += ['{}: {}'.format(function.__qualname__, name) for function, wanted in names
                for name in wanted if name not in function.__code__.co_names]
    if missing:
        raise ImportError('mhri cannot work with this rospy: it has no {}; install ros_comm 1.15 '
                          'or 1.16'.format(', '.join(missing)))


require([(ROSHandler, ('getPid', 'shutdown')),
         (rospy.topics._SubscriberImpl, ('has_connection', 'remove_connection')),
         (rospy.core, ('add_preshutdown_hook', 'is_initialized',
                       'is_shutdown_requested')),
         (rospy.names, ('_set_caller_id',))],
        [(rospy.topics._TopicImpl.__init__, (
            'connections', 'connection_poll', 'closed', 'resolved_name')),
         (TCPROSTransport.__init__, ('callerid_pub', 'endpoint_id', 'header'))])
