"""Asks for a parameter of /belvedere with Cyclone DDS, as a client of `rmw_cyclonedds` does, and prints its value, or that
there is none: cyclone_client.py NAME [TIMES]. With TIMES, the parameter is asked for as often in one request.

That client writes two numbers before the values of a request, its own and that of the request, and the reply repeats them.
"""

import sys
import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import byte, float64, int64, sequence, uint8, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

NAME, TIMES = sys.argv[1], int((*sys.argv, 1)[2])
CLIENT, NUMBER = 0x1234_5678_9ABC_DEF0, 41


@dataclass
class Value(IdlStruct, typename="rcl_interfaces::msg::dds_::ParameterValue_"):
    type: uint8
    bool_value: bool
    integer_value: int64
    double_value: float64
    string_value: str
    byte_array_value: sequence[byte]
    bool_array_value: sequence[bool]
    integer_array_value: sequence[int64]
    double_array_value: sequence[float64]
    string_array_value: sequence[str]


@dataclass
class Request(IdlStruct, typename="rcl_interfaces::srv::dds_::GetParameters_Request_"):
    client: uint64
    number: int64
    names: sequence[str]


@dataclass
class Response(IdlStruct, typename="rcl_interfaces::srv::dds_::GetParameters_Response_"):
    client: uint64
    number: int64
    values: sequence[Value]


participant = DomainParticipant(0)
qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10))
replies = DataReader(participant, Topic(participant, "rr/belvedere/get_parametersReply", Response, qos=qos), qos=qos)
requests = DataWriter(participant, Topic(participant, "rq/belvedere/get_parametersRequest", Request, qos=qos), qos=qos)
end = time.monotonic() + 10
while not requests.get_matched_subscriptions() and time.monotonic() < end:
    time.sleep(0.02)
requests.write(Request(CLIENT, NUMBER, [NAME] * TIMES))
while time.monotonic() < end:
    for reply in replies.take(10):
        assert (reply.client, reply.number) == (CLIENT, NUMBER), reply
        sys.exit(print(reply.values[0].double_value if reply.values else "none"))
    time.sleep(0.02)
sys.exit("no reply within ten seconds")
