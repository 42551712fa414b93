// Plays a session on a second emulator: node run.mjs firmware.hex < session
//
// Session: lines of "cycle hexbytes", in order, then "end cycle". Prints "cycle kind value" for every byte on SPI (S),
// every level of CSN (N) and CE (E), and every byte to the host (U); kinds and form are those of host_session.c.
import { readFileSync } from "node:fs";
import {
  AVRClock, AVREEPROM, AVRIOPort, AVRSPI, AVRTimer, AVRUSART, AVRWatchdog, CPU, EEPROMMemoryBackend, avrInstruction,
  clockConfig, eepromConfig, portBConfig, spiConfig, timer1Config, usart0Config, watchdogConfig,
} from "avr8js";

const HZ = 16e6;
const CE = 1, CSN = 2;
const MCUSR = 0x54, POWER_ON = 1;

function program(hex) {
  const bytes = new Uint8Array(32768).fill(0xff);
  for (const line of hex.split("\n").filter((line) => line.startsWith(":"))) {
    const record = Buffer.from(line.trim().slice(1), "hex");
    if (record[3] === 0) record.copy(bytes, record.readUInt16BE(1), 4, 4 + record[0]);
  }
  return new Uint16Array(bytes.buffer);
}

const cpu = new CPU(program(readFileSync(process.argv[2], "utf8")));
cpu.data[MCUSR] = POWER_ON;
const port = new AVRIOPort(cpu, portBConfig);
new AVRTimer(cpu, timer1Config);
new AVREEPROM(cpu, new EEPROMMemoryBackend(1024), eepromConfig);
new AVRWatchdog(cpu, watchdogConfig, new AVRClock(cpu, HZ, clockConfig));
const spi = new AVRSPI(cpu, spiConfig, HZ);
const serial = new AVRUSART(cpu, usart0Config, HZ);

const log = [];
const note = (kind, value) => log.push(`${cpu.cycles} ${kind} ${value}`);

// The radio answers with STATUS, then with what was written to the register that is read.
const registers = new Uint8Array(32);
let words = [];
spi.onByte = (byte) => {
  note("S", byte);
  const answer = words.length === 0 ? 0x0e : words[0] < 0x20 ? registers[words[0]] : 0;
  words.push(byte);
  cpu.addClockEvent(() => spi.completeTransfer(answer), spi.transferCycles);
};
let before = 0;
port.addListener((value) => {
  for (const [pin, kind] of [[CSN, "N"], [CE, "E"]]) {
    if ((value ^ before) >> pin & 1) note(kind, value >> pin & 1);
  }
  if ((value & ~before) >> CSN & 1) {
    if (words.length === 2 && (words[0] & 0xe0) === 0x20) registers[words[0] & 0x1f] = words[1];
  }
  if ((before ^ value) >> CSN & 1) words = [];
  before = value;
});
serial.onByteTransmit = (byte) => note("U", byte);

const waiting = [];
const feed = () => {
  if (waiting.length && serial.writeByte(waiting[0])) waiting.shift();
};
serial.onRxComplete = feed;

function runTo(cycle) {
  while (cpu.cycles < cycle) {
    avrInstruction(cpu);
    cpu.tick();
  }
}

for (const line of readFileSync(0, "utf8").trim().split("\n")) {
  const [at, ...rest] = line.split(" ");
  if (at === "end") {
    runTo(Number(rest[0]));
    break;
  }
  runTo(Number(at));
  waiting.push(...Buffer.from(rest.join(""), "hex"));
  feed();
}
console.log(log.join("\n"));
