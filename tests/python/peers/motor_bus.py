"""An emulated bus of motors behind a pseudo-terminal: Dynamixel X or Feetech STS, with the registers
that their makers document, simple physics, and whatever can go wrong.

    motor_bus.py --family dynamixel --motors '[{"id": 1}, {"id": 2}]' --log FILE

Prints {"port": ...}; then answers each line of JSON on its input with one on its output (`Desk`). The log
has a line of JSON for each instruction that came in: time, bytes, and what was wrong with it.
Only the standard library is used, and nothing of what it is to judge.
"""

import argparse
import json
import math
import os
import select
import struct
import sys
import time
import tty

TURN = 4096
STEP = 0.0005


def crc16(data: bytes) -> int:
    """Polynomial 0x8005, from zero, highest bit first: bit by bit, as it is defined."""
    remainder = 0
    for byte in data:
        remainder ^= byte << 8
        for _ in range(8):
            remainder = ((remainder << 1) ^ 0x8005 if remainder & 0x8000 else remainder << 1) & 0xFFFF
    return remainder


class Shaft:
    """What turns behind a motor: an inertia with friction, and a weight on a lever."""

    def __init__(self, own: dict):
        self.angle = own.get("angle", math.pi)  # rad, of the encoder
        self.speed = 0.0
        self.inertia = own.get("inertia", 0.01)  # kg m²
        self.viscous = own.get("viscous", 0.05)  # N m s
        self.coulomb = own.get("coulomb", 0.05)  # N m
        self.weight = own.get("weight", 0.0)  # N m, at a level lever
        self.level = own.get("level", math.pi)
        self.push = 0.0

    def advance(self, torque: float, dt: float) -> None:
        torque += self.push - self.weight * math.cos(self.angle - self.level)
        torque -= self.viscous * self.speed
        speed = self.speed + torque / self.inertia * dt
        brake = self.coulomb / self.inertia * dt
        self.speed = math.copysign(max(0.0, abs(speed) - brake), speed)
        self.angle += self.speed * dt


class Motor:
    """Registers and a shaft. `table` says of each address: bytes, and whether it can be written."""

    table: dict = {}
    locked_below = 0
    torque_enable = 0

    def __init__(self, own: dict):
        self.id = own["id"]
        self.shaft = Shaft(own)
        self.registers = bytearray(256)
        self.current = 0.0
        self.most = 0.0
        self.mute = False
        self.unheard = 0  # so many of the next instructions that switch it do not reach it
        self.heard = time.monotonic()
        self.trips = 0
        self.temperature = own.get("temperature", 30)
        self.supply = own.get("supply", 12.0)

    def put(self, address: int, value: int) -> None:
        size = self.table[address][0]
        self.registers[address : address + size] = (value % (1 << (8 * size))).to_bytes(size, "little")

    def take(self, address: int, signed: bool = False) -> int:
        size = self.table[address][0]
        return int.from_bytes(self.registers[address : address + size], "little", signed=signed)

    def misses(self, address: int) -> bool:
        missed = address == self.torque_enable and self.unheard > 0
        self.unheard -= missed
        return missed

    @property
    def on(self) -> bool:
        return self.registers[self.torque_enable] == 1

    def writable(self, address: int, length: int) -> str:
        """What is wrong with writing there; nothing where it is right."""
        at = address
        while at < address + length:
            if at not in self.table:
                return f"register {at} is not documented"
            size, can = self.table[at]
            if not can:
                return f"register {at} can only be read"
            if at < self.locked_below and self.on:
                return f"register {at} is written while the drive is on"
            at += size
        return "" if at == address + length else f"the registers from {address} on have another length"

    def readable(self, address: int, length: int) -> str:
        at = address
        while at < address + length:
            if at not in self.table:
                return f"register {at} is not documented"
            at += self.table[at][0]
        return "" if at == address + length else f"the registers from {address} on have another length"


class Dynamixel(Motor):
    """The X series: emanual.robotis.com/docs/en/dxl/x/xm430-w350 (2 of each 168 ... left out)."""

    table = {
        0: (2, 0), 2: (4, 0), 6: (1, 0), 7: (1, 1), 8: (1, 1), 9: (1, 1), 10: (1, 1), 11: (1, 1), 12: (1, 1),
        13: (1, 1), 20: (4, 1), 24: (4, 1), 31: (1, 1), 32: (2, 1), 34: (2, 1), 36: (2, 1), 38: (2, 1),
        44: (4, 1), 48: (4, 1), 52: (4, 1), 60: (1, 1), 63: (1, 1), 64: (1, 1), 65: (1, 1), 68: (1, 1),
        69: (1, 0), 70: (1, 0), 76: (2, 1), 78: (2, 1), 80: (2, 1), 82: (2, 1), 84: (2, 1), 86: (2, 0),
        88: (2, 1), 90: (2, 1), 98: (1, 1), 100: (2, 1), 102: (2, 1), 104: (4, 1), 108: (4, 1), 112: (4, 1),
        116: (4, 1), 120: (2, 0), 122: (1, 0), 123: (1, 0), 124: (2, 0), 126: (2, 0), 128: (4, 0), 132: (4, 0),
        136: (4, 0), 140: (4, 0), 144: (2, 0), 146: (1, 0),
    }  # fmt: skip
    locked_below = 64
    torque_enable = 64
    goals = range(100, 120)

    def __init__(self, own: dict):
        super().__init__(own)
        self.unit = own.get("current_unit", 0.00269)
        self.constant = own.get("torque_constant", 1.78)
        for address, value in {
            0: own.get("model", 1020), 6: 48, 7: self.id, 8: 3, 9: own.get("return_delay", 250),
            11: own.get("mode", 3), 38: own.get("current_limit", 1193), 63: 52, 68: 2,
            70: own.get("hardware", 0), 80: own.get("d_gain", 0), 84: own.get("p_gain", 800),
        }.items():  # fmt: skip
            self.put(address, value)
        self.goal_of_stop = None
        self.publish()

    def publish(self) -> None:
        position = round(self.shaft.angle / math.tau * TURN)
        self.put(126, round(self.current / self.unit))
        self.put(128, round(self.shaft.speed * 60 / math.tau / 0.229))
        self.put(132, position)
        self.put(144, round(self.supply * 10))
        self.put(146, round(self.temperature))

    def advance(self, dt: float, now: float) -> None:
        watchdog = self.take(98)
        if self.on and 1 <= watchdog <= 127 and now - self.heard > 0.020 * watchdog:
            self.put(98, 255)
            self.trips += 1
            self.goal_of_stop = self.shaft.angle / math.tau * TURN
        if self.take(98) != 255:
            self.goal_of_stop = None
        self.current = 0.0
        if self.on and self.take(11) == 5:
            # P alone; the maker's units of the gain, of the goal current, of the position.
            limit = abs(self.take(102, signed=True))
            goal = self.take(116, signed=True)
            if self.goal_of_stop is not None:
                limit, goal = self.take(38), self.goal_of_stop
            error = goal - self.shaft.angle / math.tau * TURN
            asked = self.take(84) / 128 * error
            if self.goal_of_stop is not None:
                asked -= self.shaft.speed / self.unit  # It brakes, and stands.
            self.current = max(-limit, min(limit, asked)) * self.unit
            self.most = max(self.most, abs(self.current))
        self.shaft.advance(self.current * self.constant, dt)

    def write(self, address: int, data: bytes) -> tuple[int, str]:
        wrong = self.writable(address, len(data))
        if wrong:
            return 7, wrong
        if self.take(98) == 255 and any(at in self.goals for at in range(address, address + len(data))):
            return 4, ""  # After the watchdog goals can only be read.
        if address == 98 and data[0] > 127:
            return 4, f"{data[0]} is out of range"
        if address == 64 and data[0] == 1 and not self.on:
            # As the maker has it, the goal begins at where the motor is.
            pass
        self.registers[address : address + len(data)] = data
        limit = self.take(38)
        if address == 102 and abs(self.take(102, signed=True)) > limit:
            return 6, f"a goal current beyond the limit of {limit}"
        if address == 64 and self.take(70):
            self.put(64, 0)
        return 0, ""

    def error(self) -> int:
        return 0x80 if self.take(70) else 0

    def break_down(self, bits: int) -> None:
        self.put(70, bits)
        if bits:
            self.put(64, 0)


class Feetech(Motor):
    """STS3215: Feetech's memory table of the STS series (also in LeRobot's motors/feetech/tables.py)."""

    table = {
        0: (1, 0), 1: (1, 0), 3: (2, 0), 5: (1, 1), 6: (1, 1), 7: (1, 1), 8: (1, 1), 9: (2, 1), 11: (2, 1),
        13: (1, 1), 14: (1, 1), 15: (1, 1), 16: (2, 1), 18: (1, 1), 19: (1, 1), 20: (1, 1), 21: (1, 1),
        22: (1, 1), 23: (1, 1), 24: (2, 1), 26: (1, 1), 27: (1, 1), 28: (2, 1), 30: (1, 1), 31: (2, 1),
        33: (1, 1), 34: (1, 1), 35: (1, 1), 36: (1, 1), 37: (1, 1), 38: (1, 1), 39: (1, 1),
        40: (1, 1), 41: (1, 1), 42: (2, 1), 44: (2, 1), 46: (2, 1), 48: (2, 1), 55: (1, 1),
        56: (2, 0), 58: (2, 0), 60: (2, 0), 62: (1, 0), 63: (1, 0), 64: (1, 0), 65: (1, 0), 66: (1, 0),
        67: (2, 0), 69: (2, 0),
    }  # fmt: skip
    locked_below = 40
    torque_enable = 40
    # Measured by others: firmware's duty by gain and error, and the speed that it limits goals to.
    duty_by_gain = 0.166
    fastest = 3400

    def __init__(self, own: dict):
        super().__init__(own)
        self.supply = own.get("supply", 7.4)
        self.constant = own.get("torque_constant", 0.8)
        self.resistance = own.get("resistance", 2.0)
        self.duty = 0.0
        self.status = own.get("hardware", 0)
        for address, value in {
            0: 3, 1: 10, 3: own.get("model", 777), 5: self.id, 7: own.get("return_delay", 250), 8: 1,
            9: own.get("lower", 0), 11: own.get("upper", 4095), 16: 1000, 21: own.get("p_gain", 32), 22: 32,
            33: own.get("mode", 0), 48: 1000, 55: 1,
        }.items():  # fmt: skip
            self.put(address, value)
        self.put(42, round(self.shaft.angle / math.tau * TURN))
        self.smooth = self.take(42)
        self.publish()

    @staticmethod
    def signed(value: float, bit: int) -> int:
        value = round(value)
        return min(abs(value), (1 << bit) - 1) | ((1 << bit) if value < 0 else 0)

    def publish(self) -> None:
        self.put(56, self.signed(self.shaft.angle / math.tau * TURN, 15))
        self.put(58, self.signed(self.shaft.speed / math.tau * TURN, 15))
        self.put(60, self.signed(1000 * self.duty, 10))
        self.put(62, round(10 * self.supply))
        self.put(63, round(self.temperature))
        self.put(65, self.status)
        self.put(69, round(abs(self.current) / 0.0065))

    def advance(self, dt: float, now: float) -> None:
        self.current = self.duty = 0.0
        place = self.shaft.angle / math.tau * TURN
        if self.on and self.take(33) == 0:
            goal = max(self.take(9), min(self.take(11), self.take(42)))
            way = self.fastest * dt
            self.smooth += max(-way, min(way, goal - self.smooth))
            asked = self.duty_by_gain * self.take(21) * (self.smooth - place) / TURN * math.tau
            limit = min(self.take(48), 1000) / 1000
            self.duty = max(-limit, min(limit, asked))
            self.current = (self.duty * self.supply - self.constant * self.shaft.speed) / self.resistance
            self.most = max(self.most, abs(self.duty))
        else:
            self.smooth = place
        self.shaft.advance(self.current * self.constant, dt)

    def write(self, address: int, data: bytes) -> tuple[int, str]:
        wrong = self.writable(address, len(data))
        if wrong:
            return self.status, wrong
        self.registers[address : address + len(data)] = data
        return self.status, ""

    def error(self) -> int:
        return self.status

    def break_down(self, bits: int) -> None:
        self.status = bits
        if bits:
            self.put(40, 0)


class Protocol2:
    """Packets of Dynamixel Protocol 2.0. What follows is written from its description."""

    motor = Dynamixel
    ping, read, write, sync_read, sync_write, fast = 1, 2, 3, 0x82, 0x83, 0x8A
    numbers = "<HH"

    @staticmethod
    def next(data: bytearray):
        """A packet at the beginning of `data`: (bytes, id, instruction, parameters, what is wrong)."""
        while data and not bytes(data[:4]).startswith(b"\xff\xff\xfd\x00"[: len(data)]):
            del data[0]
        if len(data) < 7:
            return None
        length = struct.unpack_from("<H", data, 5)[0]
        if len(data) < 7 + length:
            return None
        packet = bytes(data[: 7 + length])
        del data[: 7 + length]
        wrong = "" if crc16(packet[:-2]) == struct.unpack("<H", packet[-2:])[0] else "wrong CRC"
        body = packet[7:-2].replace(b"\xff\xff\xfd\xfd", b"\xff\xff\xfd")
        return packet, packet[4], body[0], body[1:], wrong

    @staticmethod
    def status(number: int, error: int, data: bytes = b"", stuffed: bool = True) -> bytes:
        body = bytes([0x55, error]) + data
        if stuffed:
            body = body.replace(b"\xff\xff\xfd", b"\xff\xff\xfd\xfd")
        packet = b"\xff\xff\xfd\x00" + bytes([number]) + struct.pack("<H", len(body) + 2) + body
        return packet + struct.pack("<H", crc16(packet))

    @classmethod
    def all_in_one(cls, answers: list) -> bytes:
        """Error, id, data and CRC of each; the last CRC is the packet's."""
        data = b""
        for place, (number, error, registers) in enumerate(answers):
            if place:
                length = sum(len(own[2]) + 4 for own in answers) + 3
                head = b"\xff\xff\xfd\x00\xfe" + struct.pack("<H", length - 2) + b"\x55" + bytes([answers[0][1]])
                data += struct.pack("<H", crc16(head + data)) + bytes([error])
            data += bytes([number]) + registers
        return cls.status(0xFE, answers[0][1], data, stuffed=False)

    @staticmethod
    def ping_data(motor) -> bytes:
        return bytes(motor.registers[0:2]) + bytes(motor.registers[6:7])


class Sts:
    """Packets of Feetech's STS motors."""

    motor = Feetech
    ping, read, write, sync_read, sync_write, fast = 1, 2, 3, 0x82, 0x83, None
    numbers = "<BB"

    @staticmethod
    def next(data: bytearray):
        while data and not bytes(data[:2]).startswith(b"\xff\xff"[: len(data)]):
            del data[0]
        if len(data) < 4 or len(data) < 4 + data[3]:
            return None
        length = data[3]
        packet = bytes(data[: 4 + length])
        del data[: 4 + length]
        wrong = "" if (sum(packet[2:]) & 0xFF) == 0xFF else "wrong sum"
        return packet, packet[2], packet[4], packet[5:-1], wrong

    @staticmethod
    def status(number: int, error: int, data: bytes = b"", stuffed: bool = True) -> bytes:
        body = bytes([number, len(data) + 2, error]) + data
        return b"\xff\xff" + body + bytes([0xFF - (sum(body) & 0xFF)])

    @staticmethod
    def ping_data(motor) -> bytes:
        return b""


class Bus:
    def __init__(self, options):
        self.protocol = {"dynamixel": Protocol2, "feetech": Sts}[options.family]
        self.motors = {own["id"]: self.protocol.motor(own) for own in json.loads(options.motors)}
        self.log = open(options.log, "w", buffering=1)
        self.baud = options.baud
        self.old = options.old_firmware
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        self.name = os.ttyname(self.slave)
        self.input = bytearray()
        self.now = time.monotonic()
        self.damaged = 0

    def advance(self) -> None:
        now = time.monotonic()
        steps = int((now - self.now) / STEP)
        for step in range(min(steps, 400)):
            for motor in self.motors.values():
                motor.advance(STEP, self.now + step * STEP)
        self.now += steps * STEP
        for motor in self.motors.values():
            motor.publish()

    def answer(self, packet: bytes) -> None:
        if self.damaged:
            self.damaged -= 1
            packet = packet[:-1] + bytes([packet[-1] ^ 0x10])
        if self.baud:
            time.sleep(len(packet) * 10 / self.baud)
        os.write(self.master, packet)

    def receive(self) -> None:
        self.input += os.read(self.master, 4096)
        while found := self.protocol.next(self.input):
            packet, number, instruction, parameters, wrong = found
            if self.baud:
                time.sleep(len(packet) * 10 / self.baud)
            self.advance()
            wrong = wrong or self.obey(number, instruction, parameters)
            entry = {"t": round(time.monotonic(), 5), "packet": packet.hex()}
            if wrong:
                entry["wrong"] = wrong
            self.log.write(json.dumps(entry) + "\n")

    def obey(self, number: int, instruction: int, parameters: bytes) -> str:
        own, size = self.protocol, struct.calcsize(self.protocol.numbers)
        heard = self.motors.values() if number == 0xFE else [m for m in [self.motors.get(number)] if m]
        for motor in heard:
            if not motor.mute:
                motor.heard = time.monotonic()
        if number != 0xFE:
            if not heard or heard[0].mute:
                return ""
            motor = heard[0]
            if instruction == own.ping:
                self.answer(own.status(number, motor.error(), own.ping_data(motor)))
                return ""
            if instruction == own.read:
                address, length = struct.unpack(own.numbers, parameters)
                wrong = motor.readable(address, length)
                data = bytes(motor.registers[address : address + length])
                self.answer(own.status(number, motor.error(), data))
                return wrong
            if instruction == own.write:
                half = size // 2
                address = int.from_bytes(parameters[:half], "little")
                if motor.misses(address):
                    return ""
                error, wrong = motor.write(address, parameters[half:])
                self.answer(own.status(number, motor.error() | error))
                return wrong
            return f"instruction {instruction} is not known"
        if instruction not in (own.sync_read, own.sync_write, own.fast):
            return f"instruction {instruction} is not for all"
        address, length = struct.unpack_from(own.numbers, parameters)
        rest = parameters[size:]
        wrongs = []
        if instruction == own.sync_write:
            for at in range(0, len(rest), 1 + length):
                motor = self.motors.get(rest[at])
                if motor and not motor.mute and not motor.misses(address):
                    wrongs.append(motor.write(address, rest[at + 1 : at + 1 + length])[1])
            return "; ".join(filter(None, wrongs))
        asked = [self.motors[own] for own in rest if own in self.motors and not self.motors[own].mute]
        wrongs = [motor.readable(address, length) for motor in asked]
        answers = [(m.id, m.error(), bytes(m.registers[address : address + length])) for m in asked]
        if instruction == own.fast:
            if not self.old and len(answers) == len(rest):
                self.answer(own.all_in_one(answers))
        else:
            for one in answers:
                self.answer(own.status(*one))
                if one[0] != rest[answers.index(one)]:
                    break  # Each waits for the one before it.
        return "; ".join(filter(None, wrongs))

    def close(self) -> None:
        for descriptor in (self.master, self.slave):
            os.close(descriptor)
        self.master = self.slave = None


class Desk:
    """What a test asks for: {"do": ..., "id": ..., ...}; all motors where no id is given."""

    def __init__(self, bus: Bus):
        self.bus = bus

    def handle(self, asked: dict) -> dict:
        self.bus.advance()
        motors = [m for m in self.bus.motors.values() if asked.get("id") in (None, m.id)]
        match asked["do"]:
            case "state":
                return {"motors": [self.state(motor) for motor in motors]}
            case "break":
                for motor in motors:
                    motor.break_down(asked["bits"])
            case "mute":
                for motor in motors:
                    motor.mute = asked.get("on", True)
            case "unheard":
                for motor in motors:
                    motor.unheard = asked["times"]
            case "switch_off":
                for motor in motors:
                    motor.put(motor.torque_enable, 0)
            case "damage":
                self.bus.damaged = asked["answers"]
            case "push":
                for motor in motors:
                    motor.shaft.push = asked["torque"]
            case "heat":
                for motor in motors:
                    motor.temperature = asked["degrees"]
            case "close":
                self.bus.close()
        return {}

    @staticmethod
    def state(motor: Motor) -> dict:
        return {
            "id": motor.id,
            "position": motor.shaft.angle / math.tau * TURN,
            "velocity": motor.shaft.speed,
            "current": motor.current,
            "most": motor.most,
            "on": motor.on,
            "trips": motor.trips,
            "registers": motor.registers.hex(),
        }


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--family", choices=["dynamixel", "feetech"], required=True)
    parser.add_argument("--motors", required=True)
    parser.add_argument("--log", required=True)
    parser.add_argument("--baud", type=int, default=0, help="how long bytes take; no time without it")
    parser.add_argument("--old-firmware", action="store_true", help="does not know the fast sync read")
    bus = Bus(parser.parse_args())
    desk = Desk(bus)
    print(json.dumps({"port": bus.name}), flush=True)
    lines = b""
    while True:
        watched = [0] + ([bus.master] if bus.master is not None else [])
        ready, _, _ = select.select(watched, [], [], 0.002)
        bus.advance()
        if bus.master is not None and bus.master in ready:
            bus.receive()
        if 0 in ready:
            got = os.read(0, 4096)
            if not got:
                return
            lines += got
            while b"\n" in lines:
                line, lines = lines.split(b"\n", 1)
                print(json.dumps(desk.handle(json.loads(line))), flush=True)


if __name__ == "__main__":
    sys.exit(main())
