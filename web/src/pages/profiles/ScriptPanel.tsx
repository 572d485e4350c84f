import { Button, CopyButton, Loader, Tabs, Text } from "@mantine/core";
import { IconCheck, IconCopy, IconDownload, IconShieldCheck } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { api, type Schemas } from "../../api/client";
import { useModel } from "../../api/queries";
import { Card } from "../../lib/Card";
import { saveText } from "../../lib/files";
import { compact, fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { type Language, tokensOf } from "./highlight";
import css from "./profiles.module.css";
import type { Saved } from "./useProfiles";

const NAMES: Readonly<Record<Language, string>> = { python: "Python", curl: "curl", c: "C", tmcl: "TMCL" };

/** The profile as a program, in each language that there is for its model. */
export function ScriptPanel({ profile }: { profile: Saved }) {
  const model = useModel(profile.model);
  const languages = (Object.keys(NAMES) as Language[]).filter(
    (language) => language !== "tmcl" || model?.kind === "module",
  );
  const [language, setLanguage] = useState<Language | null>(null);
  return (
    <Card title="Script" note="tried on an emulator before you get it">
      <Tabs value={language} onChange={(value) => setLanguage(value as Language | null)} keepMounted={false}>
        <Tabs.List aria-label="Language">
          {languages.map((each) => (
            <Tabs.Tab key={each} value={each}>
              {NAMES[each]}
            </Tabs.Tab>
          ))}
        </Tabs.List>
        {language === null && (
          <Text className="hint" mt={8}>
            Choose a language. The script is made and tried on an emulator of a {profile.title}, which takes some
            seconds; after that it is at hand.
          </Text>
        )}
        {languages.map((each) => (
          <Tabs.Panel key={each} value={each} pt="xs">
            <OneScript profile={profile} language={each} />
          </Tabs.Panel>
        ))}
      </Tabs>
    </Card>
  );
}

function OneScript({ profile, language }: { profile: Saved; language: Language }) {
  const script = useQuery({
    // a name and a note are remarks of the script
    queryKey: ["profiles", profile.id, "script", language, profile.name, profile.note],
    queryFn: () => api.GET("/api/v1/profiles/{profile}/script", { path: { profile: profile.id }, query: { language } }),
    staleTime: Number.POSITIVE_INFINITY,
    retry: false,
  });
  if (script.isPending)
    return (
      <div className="row gap-8" role="status">
        <Loader size="xs" aria-hidden />
        <Text size="sm">
          The {NAMES[language]} script is being tried on an emulator of a {profile.model.toUpperCase()}; that takes some
          seconds.
        </Text>
      </div>
    );
  if (script.isError)
    return (
      <ProblemAlert
        error={script.error}
        doing={`Making the ${NAMES[language]} script`}
        retry={() => void script.refetch()}
      />
    );
  const { text, file_name, checked } = script.data;
  return (
    <div className="grid gap-8">
      <div className={`${css.seal} lines-8`} data-testid="seal">
        <IconShieldCheck size={18} aria-hidden />
        <Text size="sm">
          <b>Checked on the emulator.</b> {HOW[checked.how]} An emulated {checked.model.toUpperCase()} then held all{" "}
          <span className="num">{fixed(checked.registers)}</span> registers as the profile says, with no difference and
          its motors standing; <span className="num">{compact(checked.took_s, 2)}</span> s.
        </Text>
        <div className="flex wrap gap-6">
          <CopyButton value={text} timeout={1500}>
            {({ copied, copy }) => (
              <Button
                size="compact-sm"
                variant="default"
                leftSection={copied ? <IconCheck size={14} aria-hidden /> : <IconCopy size={14} aria-hidden />}
                onClick={copy}
              >
                {copied ? "Copied" : "Copy"}
              </Button>
            )}
          </CopyButton>
          <Button
            size="compact-sm"
            variant="default"
            leftSection={<IconDownload size={14} aria-hidden />}
            onClick={() => saveText(file_name, text)}
          >
            {file_name}
          </Button>
        </div>
      </div>
      <Program text={text} language={language} />
    </div>
  );
}

/** How the trial was made: it need not have been the program itself where a machine lacks what it runs in. */
const HOW: Readonly<Record<Schemas["ScriptCheck"]["how"], string>> = {
  run: "It ran as a program, against a server with a fresh device or on a fresh module.",
  sent: "Its commands were sent to a fresh module, one by one: the emulated one has no memory for programs.",
  compiled: "It was compiled without a warning, and its frames were sent to a fresh chip.",
  read: "What it writes was read back out of it and sent: this machine lacks what it would run in.",
};

const TOKEN_LOOKS = { remark: "dim", word: "bold", text: "good", number: "accent" };

function Program({ text, language }: { text: string; language: Language }) {
  let place = 0;
  return (
    <section
      className={`${css.program} box m-0 text-12 mono tight scroll`}
      // biome-ignore lint/a11y/noNoninteractiveTabindex: what can be scrolled must be reached by keyboard
      tabIndex={0}
      aria-label={`${NAMES[language]} script`}
    >
      <pre className="m-0 mono">
        <code>
          {tokensOf(text, language).map((token) => {
            const key = place;
            place += token.text.length;
            return token.kind === "plain" ? (
              token.text
            ) : (
              <span key={key} className={TOKEN_LOOKS[token.kind]}>
                {token.text}
              </span>
            );
          })}
        </code>
      </pre>
    </section>
  );
}
