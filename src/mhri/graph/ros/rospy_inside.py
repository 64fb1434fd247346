# SPDX-FileCopyrightText: 2026 The mhri authors
# SPDX-License-Identifier: BSD-3-Clause
"""All that reaches beneath rospy's public interface, in one place, tested at import.

Nobody develops rospy any further (ros_comm was archived in 2025), but a distribution may patch it:
this module looks at import for all it relies on, and an :class:`ImportError` says what is missing.
How messages go in and out on the driving path is in :mod:`mhri.graph.ros.prompt`.

:func:`caller_of`, :func:`listeners`, :func:`on_publisher_gone`, :func:`publisher_processes` and
:func:`publisher_uri` tell who is at the other end of a connection, and when it is gone.
"""
import rospy
from rospy.impl.masterslave import ROSHandler
from rospy.impl.paramserver import get_param_server_cache
from rospy.impl.registration import (
    get_registration_listeners, get_service_manager, get_topic_manager)
from rospy.impl.tcpros_base import TCPROSTransport


def caller_of(message):
    """Return the caller id of whoever sent a message, '' if unknown."""
    return (message._connection_header or {}).get('callerid', '')


def type_of(message):
    """Return the ROS type of a message as its publisher named it."""
    return message._connection_header['type']


def md5sum_of(message):
    """Return the md5sum of a message's definition as its publisher named it, '' if unknown."""
    return message._connection_header.get('md5sum', '')


def link_of(message):
    """Return an object that is the same for all messages of one connection."""
    return message._connection_header


def listeners(connections):
    """Return the caller ids at the other end of a publisher's connections."""
    return {connection.endpoint_id for connection in connections}


def peer_hosts(connections):
    """Return {caller id: network address} of who is at the other end of connections."""
    found = {}
    for connection in connections:
        try:
            host = connection.socket.getpeername()[0]
        except (OSError, AttributeError, IndexError):
            continue  # it has just ended
        caller = connection.callerid_pub
        found[connection.endpoint_id if caller == 'unknown' else caller] = host
    return found


def publisher_hosts(subscriber):
    """Return {caller id: network address} of the publishers connected to a ``rospy.Subscriber``."""
    impl = subscriber.impl
    return peer_hosts(impl.connections if impl else ())


def publishers(subscriber):
    """Return the caller ids of the publishers that are connected to a ``rospy.Subscriber``."""
    impl = subscriber.impl
    return {link.callerid_pub for link in (impl.connections if impl else ())}


def publisher_uri(subscriber, caller=None):
    """Return the XML-RPC address of a node that publishes the subscribed topic, or None.

    :param caller: the caller id of that node; default: any
    """
    return next((uri for name, uri in publisher_processes(subscriber)
                 if uri and caller in (None, name)), None)


def publisher_processes(subscriber):
    """Return (caller id, XML-RPC address) of each publisher that is connected, as a list."""
    impl = subscriber.impl
    return [(link.callerid_pub, link.endpoint_id) for link in (impl.connections if impl else ())]


def sender_uri(subscriber, message):
    """Return the XML-RPC address of whoever sent a message to a subscriber, '' if unknown."""
    impl = subscriber.impl
    return next((link.endpoint_id for link in (impl.connections if impl else ())
                 if link.header is link_of(message)), None) or ''


def latches(message):
    """Tell whether the publisher of a message keeps its last one for whoever connects later."""
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
        """Let rospy forget the connection, then tell."""
        plain(connection)
        who = connection.callerid_pub, connection.endpoint_id
        if who not in publisher_processes(subscriber):
            call(*who)

    impl.remove_connection = remove_connection


_OTHERS_ONLY = set()
_has_connection = rospy.topics._SubscriberImpl.has_connection


def _connected(impl, endpoint_id):
    """Tell whether a subscription has a connection, or is to have none, to a publisher."""
    return (impl.resolved_name in _OTHERS_ONLY and endpoint_id == rospy.get_node_uri()
            or _has_connection(impl, endpoint_id))


rospy.topics._SubscriberImpl.has_connection = _connected


def others_only(topic):
    """Let subscribers of a topic never connect to this node itself, which publishes it, too.

    Every message would come back, and be read on a thread of its own. Call it before subscribing.

    :param topic: its absolute name
    """
    _OTHERS_ONLY.add(rospy.names.resolve_name(topic))


def is_initialised():
    """Tell whether somebody in this process has called ``rospy.init_node``."""
    return rospy.core.is_initialized()


def ended_by_hand():
    """Return a function that tells whether somebody ended this node by ``rosnode kill``.

    The master, which ends the older of two nodes with one name, does not count. Call it after
    ``init_node``.
    """
    reasons = []
    rospy.core.add_preshutdown_hook(reasons.append)
    return lambda: any('user request' in reason for reason in reasons)


def unsubscribe(subscriber):
    """Unregister a ``rospy.Subscriber`` (blocking: it asks the master).

    rospy leaves the epoll handle of the topic open until the garbage collector comes to its oldest
    generation (ros_comm issue 2373), hundreds of them as an operator toggles views: this closes it.
    """
    impl = subscriber.impl
    subscriber.unregister()
    if impl is not None and impl.closed:
        impl.connection_poll.poller.close()


def never_ask_for(name, value):
    """Tell rospy the value of a parameter, so that it never asks the master for it."""
    get_param_server_cache().set(name, value)


def skip_number(publisher):
    """Count a message of a ``rospy.Publisher`` that is not sent, as if it were lost on the way."""
    publisher.impl.seq += 1


def answer_late(wait):
    """Call a function before this process answers who asks for its id, as the link probe does."""
    plain = ROSHandler.getPid

    def get_pid(handler, caller_id):
        wait()
        return plain(handler, caller_id)

    ROSHandler.getPid = get_pid


def is_ending():
    """Tell whether this node ends: its registrations go before ``is_shutdown`` says so."""
    return rospy.core.is_shutdown_requested()


def registrations():
    """Return this node's registrations: ([(topic, type)], [(service, URI)], [(topic, type)]).

    These are publications, services and subscriptions.
    """
    topics = get_topic_manager()
    return (topics.get_publications(), get_service_manager().get_services(),
            topics.get_subscriptions())


def meet_publishers(topic, uris):
    """Connect this node's subscription to publishers, as if the master had reported them."""
    manager = next(iter(get_registration_listeners().listeners), None)
    if manager is not None:
        manager.publisher_update(topic, uris)


def require(methods, names):
    """Check for what a module relies on.

    :param methods: [(class or module, names of its functions)]
    :param names: [(function, names that it uses)]
    :raises ImportError: rospy is not the version this was written for
    """
    missing = ['{}.{}'.format(owner.__name__, name) for owner, wanted in methods for name in wanted
               if not callable(getattr(owner, name, None))]
    missing += ['{}: {}'.format(function.__qualname__, name) for function, wanted in names
                for name in wanted if name not in function.__code__.co_names]
    if missing:
        raise ImportError('mhri cannot work with this rospy: it has no {}; install ros_comm 1.15 '
                          'or 1.16'.format(', '.join(missing)))


require([(ROSHandler, ('getPid',)),
         (rospy.topics._SubscriberImpl, ('has_connection', 'remove_connection')),
         (rospy.core, ('add_preshutdown_hook', 'is_initialized',
                       'is_shutdown_requested'))],
        [(rospy.topics._TopicImpl.__init__, (
            'connections', 'connection_poll', 'closed', 'resolved_name')),
         (TCPROSTransport.__init__, ('callerid_pub', 'endpoint_id', 'header'))])
