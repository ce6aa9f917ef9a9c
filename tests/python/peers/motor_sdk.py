"""The makers' own SDKs (PyPI dynamixel-sdk, feetech-servo-sdk) as referees: JSON in, JSON out.

{"family": ..., "port": ..., "baud": ..., "operations": [...]} does what is listed on that port:
    ["ping", id]  ["read", id, address, bytes]  ["write", id, address, [...]]
    ["sync_read", [ids], address, bytes]  ["fast_sync_read", ...]  ["sync_write", address, bytes, {id: [...]}]
{"family": ..., "log": FILE} has the SDK write each instruction of an emulated bus's log again, and tells which
packets it writes differently.
"""

import json
import struct
import sys


class Silent:
    """A port on which nobody answers, that keeps what is written."""

    baudrate = 1_000_000

    def __init__(self):
        self.written = []
        self.is_using = False

    def clearPort(self):
        pass

    def writePort(self, packet):
        self.written.append(bytes(packet))
        return len(packet)

    def readPort(self, length):
        return b""

    def setPacketTimeout(self, length):
        pass

    def isPacketTimeout(self):
        return True


class Sdk:
    def __init__(self, family: str):
        self.family = family
        if family == "dynamixel":
            import dynamixel_sdk as sdk

            self.packets = sdk.Protocol2PacketHandler()
            self.numbers, self.head = "<HH", 7
        else:
            import scservo_sdk as sdk

            self.packets = sdk.protocol_packet_handler()
            self.numbers, self.head = "<BB", 4
        self.sdk = sdk

    def open(self, name: str, baud: int):
        port = self.sdk.PortHandler(name)
        # The order differs between the makers.
        assert port.openPort() and port.setBaudRate(baud)
        return port

    def do(self, port, operation: list):
        what, *rest = operation
        if what == "ping":
            return list(self.packets.ping(port, rest[0]))
        if what == "read":
            data, result, error = self.packets.readTxRx(port, *rest)
            return [list(data), result, error]
        if what == "write":
            number, address, data = rest
            return list(self.packets.writeTxRx(port, number, address, len(data), data))
        if what in ("sync_read", "fast_sync_read"):
            ids, address, length = rest
            group = self.sdk.GroupSyncRead(port, self.packets, address, length)
            for number in ids:
                assert group.addParam(number)
            result = group.fastSyncRead() if what == "fast_sync_read" else group.txRxPacket()
            return [[list(group.data_dict[number]) for number in ids], result]
        if what == "sync_write":
            address, length, data = rest
            group = self.sdk.GroupSyncWrite(port, self.packets, address, length)
            for number, own in data.items():
                assert group.addParam(int(number), own)
            return group.txPacket()
        raise ValueError(what)

    def operation_of(self, packet: bytes) -> list:
        """What the SDK is asked for to write that packet."""
        number = packet[4] if self.family == "dynamixel" else packet[2]
        body = packet[self.head : -2] if self.family == "dynamixel" else packet[self.head : -1]
        instruction, parameters = body[0], body[1:]
        size = struct.calcsize(self.numbers)
        if instruction == 1:
            return ["ping", number]
        if instruction == 3:
            half = size // 2
            return ["write", number, int.from_bytes(parameters[:half], "little"), list(parameters[half:])]
        address, length = struct.unpack_from(self.numbers, parameters)
        rest = parameters[size:]
        if instruction == 2:
            return ["read", number, address, length]
        if instruction == 0x83:
            own = {rest[at]: list(rest[at + 1 : at + 1 + length]) for at in range(0, len(rest), 1 + length)}
            return ["sync_write", address, length, own]
        names = {0x82: "sync_read", 0x8A: "fast_sync_read"}
        return [names[instruction], list(rest), address, length]

    def write_again(self, log: str) -> dict:
        packets, wrong, different, kinds = 0, [], [], {}
        for line in open(log):
            entry = json.loads(line)
            packets += 1
            if "wrong" in entry:
                wrong.append(entry["wrong"])
            packet = bytes.fromhex(entry["packet"])
            operation = self.operation_of(packet)
            kinds[operation[0]] = kinds.get(operation[0], 0) + 1
            port = Silent()
            self.do(port, operation)
            if port.written[0] != packet:
                different.append([entry["packet"], port.written[0].hex()])
        return {"packets": packets, "wrong": wrong[:10], "different": different[:10], "kinds": kinds}


def main() -> None:
    asked = json.load(sys.stdin)
    sdk = Sdk(asked["family"])
    if "log" in asked:
        json.dump(sdk.write_again(asked["log"]), sys.stdout)
        return
    port = sdk.open(asked["port"], asked["baud"])
    results = [sdk.do(port, operation) for operation in asked["operations"]]
    port.closePort()
    json.dump({"results": results}, sys.stdout)


if __name__ == "__main__":
    main()
