// The form of a campaign by sections; rarely used ones are collapsed.
import { memo } from 'react'
import { AboutForm } from './AboutForm'
import { CriterionForm } from './CriterionForm'
import { MethodsTable } from './MethodsTable'
import { hasScenario } from '../../api/campaign'
import type { FormProps } from '../fields/props'
import { ProposalCard } from '../proposal/ProposalCard'
import { ScenarioForm } from './ScenarioForm'
import { SettingsForm } from './SettingsForm'
import { ResultForm, SimulatorForm } from './SimulatorForm'
import { UncertainTable } from './UncertainTable'

/** Rendered again only if the campaign changes, not while its text is checked. */
export const CampaignForm = memo(function CampaignForm(form: FormProps) {
  const flies = hasScenario(form.campaign)
  return (
    <>
      <UncertainTable {...form} />
      {flies ? <CriterionForm {...form} /> : <ResultForm {...form} />}
      {!flies && <ProposalCard {...form} />}
      <MethodsTable {...form} />
      <SettingsForm {...form} />
      {flies ? <ScenarioForm {...form} /> : <SimulatorForm {...form} />}
      <AboutForm {...form} />
    </>
  )
})
