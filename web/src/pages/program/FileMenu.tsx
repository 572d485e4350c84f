import { Button, Menu } from "@mantine/core";
import { IconChevronDown, IconFile } from "@tabler/icons-react";
import { useRef } from "react";
import { api } from "../../api/client";
import { fileName } from "../../lib/files";
import { EXAMPLES } from "./examples";
import { fromBase64, toBase64 } from "./lines";
import { bodyOf } from "./usePrograms";

interface Props {
  device: string;
  connected: boolean;
  name: string;
  text: string;
  onOpen: (name: string, text: string) => void;
  /** does something that may fail, and says what */
  attempt: (doing: string, work: () => Promise<void>) => void;
}

const FIRST_PIECE = 128;
const MEMORY = 2048;
const SIZE_MAX = 500_000;

/** Files of programs, as text and as bytes; the module's memory; examples. */
export function FileMenu({ device, connected, name, text, onOpen, attempt }: Props) {
  const input = useRef<HTMLInputElement>(null);
  const path = { path: { device } };
  const stem = name.replace(/\.\w+$/, "") || "program";

  async function open(file: File) {
    if (file.size > SIZE_MAX) throw new Error(`${file.name} has ${file.size} bytes; a program has ${SIZE_MAX} at most`);
    if (!/\.bin$/i.test(file.name)) {
      onOpen(file.name, await file.text());
      return;
    }
    const binary = toBase64(new Uint8Array(await file.arrayBuffer()));
    const made = await api.POST("/api/v1/devices/{device}/program/disassemble", { ...path, body: { binary } });
    onOpen(file.name.replace(/\.bin$/i, ".tmc"), made.text);
  }

  async function saveBinary() {
    const made = await api.POST("/api/v1/devices/{device}/program/assemble", {
      ...path,
      body: { ...bodyOf(name, text), listing: false, binary: true },
    });
    const [problem] = made.problems;
    if (problem) throw new Error(`line ${problem.line}: ${problem.message}`);
    save(`${fileName(stem, ".bin")}`, fromBase64(made.binary ?? ""));
  }

  async function read() {
    let whole = "";
    // labels are told of a piece that begins at 0: twice as much each time reads no command more than twice or so
    for (let count = FIRST_PIECE; count <= MEMORY; count *= 2) {
      const piece = await api.GET("/api/v1/devices/{device}/program", { ...path, query: { address: 0, count } });
      whole = piece.text;
      if (/(?:^\s*\.command 0, 0, 0, 0\n){8}$/m.test(`${whole.trimEnd()}\n`)) break;
    }
    onOpen(
      "module.tmc",
      whole
        .replace(/(?:^\s*\.command 0, 0, 0, 0\n?)+$/m, "")
        .trimEnd()
        .concat("\n"),
    );
  }

  return (
    <>
      <input
        ref={input}
        type="file"
        hidden
        accept=".tmc,.txt,.bin"
        aria-label="Program file"
        onChange={({ currentTarget }) => {
          const [file] = currentTarget.files ?? [];
          currentTarget.value = "";
          if (file) attempt(`Opening ${file.name}`, () => open(file));
        }}
      />
      <Menu position="bottom-start">
        <Menu.Target>
          <Button
            variant="default"
            leftSection={<IconFile size={16} aria-hidden />}
            rightSection={<IconChevronDown size={14} aria-hidden />}
          >
            File
          </Button>
        </Menu.Target>
        <Menu.Dropdown>
          <Menu.Item onClick={() => input.current?.click()}>Open a file (.tmc, .bin)…</Menu.Item>
          <Menu.Item onClick={() => save(fileName(stem, ".tmc"), new TextEncoder().encode(text))}>
            Save as text (.tmc)
          </Menu.Item>
          <Menu.Item onClick={() => attempt("Saving the binary file", saveBinary)}>Save as binary (.bin)</Menu.Item>
          <Menu.Item disabled={!connected} onClick={() => attempt("Reading the module's memory", read)}>
            Read from the module
          </Menu.Item>
          <Menu.Divider />
          <Menu.Label>Examples</Menu.Label>
          {EXAMPLES.map((example) => (
            <Menu.Item
              key={example.name}
              rightSection={<span className="dim text-12">{example.from}</span>}
              onClick={() => onOpen(fileName(example.name, ".tmc"), example.text)}
            >
              {example.name}
            </Menu.Item>
          ))}
        </Menu.Dropdown>
      </Menu>
    </>
  );
}

function save(name: string, bytes: Uint8Array<ArrayBuffer>): void {
  const address = URL.createObjectURL(new Blob([bytes], { type: "application/octet-stream" }));
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000); // the browser has it by then
}
